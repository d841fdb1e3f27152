#include "stages/geometry/xml.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "stages/error.hpp"

namespace seampath {
namespace {

class Scanner {
public:
    Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    std::vector<XmlElement> elements() {
        std::vector<XmlElement> all;
        std::vector<std::string> open;
        while (skip_to_tag()) {
            if (accept("</")) {
                const std::string tag = name();
                if (open.empty() || open.back() != tag) {
                    fail("</" + tag + "> closes " + (open.empty() ? "nothing" : "<" + open.back() + ">"));
                }
                open.pop_back();
                blanks();
                expect(">");
                continue;
            }
            expect("<");
            if (open.empty() && !all.empty()) {
                fail("a second element stands beside the first");
            }
            XmlElement element{name(), {}, open.size(), line_};
            read_attributes(element);
            if (accept("/>")) {
                all.push_back(std::move(element));
                continue;
            }
            expect(">");
            open.push_back(element.name);
            all.push_back(std::move(element));
        }
        if (!open.empty() || all.empty()) {
            fail(all.empty() ? "there is no element" : "<" + open.back() + "> is not closed");
        }
        return all;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError("xml: " + file_ + ":" + std::to_string(line_) + ": " + what + "; well-formed XML was needed");
    }

    bool done() const { return at_ >= text_.size(); }

    void advance(std::size_t count) {
        for (; count > 0 && !done(); --count, ++at_) {
            line_ += text_[at_] == '\n' ? 1 : 0;
        }
    }

    bool accept(std::string_view token) {
        if (!text_.substr(at_).starts_with(token)) {
            return false;
        }
        advance(token.size());
        return true;
    }

    void expect(std::string_view token) {
        if (!accept(token)) {
            fail("\"" + std::string(token) + "\" is missing");
        }
    }

    void skip_past(std::string_view token) {
        const auto end = text_.find(token, at_);
        if (end == std::string_view::npos) {
            fail("\"" + std::string(token) + "\" is missing");
        }
        advance(end + token.size() - at_);
    }

    /// To the next start or end tag; false at the end of the text.
    bool skip_to_tag() {
        while (true) {
            const auto tag = text_.find('<', at_);
            advance((tag == std::string_view::npos ? text_.size() : tag) - at_);
            if (done()) {
                return false;
            }
            if (accept("<!--")) {
                skip_past("-->");
            } else if (accept("<?")) {
                skip_past("?>");
            } else if (accept("<![CDATA[")) {
                skip_past("]]>");
            } else if (accept("<!")) {
                skip_past(">");
            } else {
                return true;
            }
        }
    }

    static bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

    void blanks() {
        while (!done() && blank(text_[at_])) {
            advance(1);
        }
    }

    std::string name() {
        const auto begin = at_;
        while (!done() && !blank(text_[at_]) &&
               std::string_view("<>/=\"'&").find(text_[at_]) == std::string_view::npos) {
            advance(1);
        }
        if (at_ == begin) {
            fail("a name is missing");
        }
        return std::string(text_.substr(begin, at_ - begin));
    }

    void read_attributes(XmlElement& element) {
        for (blanks(); !done() && text_[at_] != '>' && text_[at_] != '/'; blanks()) {
            const std::string key = name();
            blanks();
            expect("=");
            blanks();
            const std::string quote(accept("\"") ? "\"" : "'");
            if (quote == "'") {
                expect(quote);
            }
            const auto begin = at_;
            skip_past(quote);
            if (!element.attributes.emplace(key, resolved(text_.substr(begin, at_ - 1 - begin))).second) {
                fail("<" + element.name + "> has " + key + " twice");
            }
        }
    }

    std::string resolved(std::string_view raw) const {
        constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
            {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}}};
        std::string text;
        while (!raw.empty()) {
            const auto entity = std::find_if(kEntities.begin(), kEntities.end(),
                                             [&](const auto& e) { return raw.starts_with(e.first); });
            if (raw.front() == '&' && entity == kEntities.end()) {
                fail("an entity that is none of &lt; &gt; &amp; &quot; &apos;");
            }
            text += entity == kEntities.end() ? raw.front() : entity->second;
            raw.remove_prefix(entity == kEntities.end() ? 1 : entity->first.size());
        }
        return text;
    }

    std::string_view text_;
    const std::string& file_;
    std::size_t at_ = 0, line_ = 1;
};

}  // namespace

std::vector<XmlElement> xml_elements(std::string_view text, const std::string& file) {
    return Scanner(text, file).elements();
}

}  // namespace seampath
