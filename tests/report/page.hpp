#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/test_folder.hpp"

/// What tests ask of a page, as text and in a real browser.
namespace seampath::test {

using Json = nlohmann::json;

/// Row of report.json at a path such as "seams.0.length_mm" or "scan.noise_mm".
inline Json row_at(const Json& report, const std::string& path) {
    const std::size_t dot = path.find_last_of('.');
    const std::string place = path.substr(0, dot), name = path.substr(dot + 1);
    const std::size_t inner = place.find('.');
    const Json& entry = inner == std::string::npos
                            ? report.at(place)
                            : report.at(place.substr(0, inner)).at(std::stoul(place.substr(inner + 1)));
    for (const Json& row : entry.is_array() ? entry : entry.at("rows")) {
        if (row.at("name") == name) {
            return row;
        }
    }
    return {};
}

/// For pages: a failed HasSubstr would print megabytes.
inline bool holds(const std::string& page, std::string_view text) {
    return page.find(text) != std::string::npos;
}

inline std::string without_groups(std::string text) {
    for (std::size_t at = text.find("\u202f"); at != std::string::npos; at = text.find("\u202f")) {
        text.erase(at, std::string("\u202f").size());
    }
    return text;
}

/// A text that a page shows is this number, rounded to the places that are shown.
inline void expect_shown(std::string text, double value, const std::string& where) {
    text = without_groups(text);
    if (text.starts_with("&lt;")) {
        EXPECT_LT(std::abs(value), std::stod(text.substr(4))) << where;
        return;
    }
    const std::size_t point = text.find('.');
    const double place = point == std::string::npos ? 1 : std::pow(10, -static_cast<double>(text.size() - point - 1));
    EXPECT_NEAR(std::stod(text), value, 0.5000001 * place) << where;
}

/// What a page shows at each data-row, and at each data-at, a JSON pointer, is the value there in report.json. Returns
/// how many numbers were compared.
inline int expect_numbers_equal(const std::string& page, const Json& report) {
    const std::regex cell("data-(row|at)=\"([^\"]+)\" data-value=\"([^\"]*)\">([^<]*)<");
    int numbers = 0;
    for (std::sregex_iterator it(page.begin(), page.end(), cell), end; it != end; ++it) {
        const Json value =
            (*it)[1] == "row" ? row_at(report, (*it)[2]).at("value") : report.at(Json::json_pointer((*it)[2]));
        if (!value.is_number()) {
            continue;
        }
        ++numbers;
        EXPECT_EQ(std::stod((*it)[3]), value.get<double>()) << it->str();
        expect_shown((*it)[4], value.get<double>(), it->str());
    }
    return numbers;
}

/// Opens pages in headless Chromium, drawing in software.
class InBrowser : public testing::Test {
protected:
    void SetUp() override {
        for (const char* program : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"}) {
            if (std::filesystem::exists(program)) {
                browser_ = program;
            }
        }
        if (browser_.empty()) {
            GTEST_SKIP() << "no Chromium on this machine (Debian package chromium)";
        }
    }

    /// The document after its scripts have run, `script` last of them; `options` are more for the browser. What a
    /// script reports as an error, what the page's own rules kept from being loaded, and what was loaded nevertheless
    /// stands in data-trouble of the body's element.
    std::string dom(std::string page, const std::string& script = "", const std::string& options = "") {
        const std::string watch =
            "<script>window.trouble = [];"
            "addEventListener('error', (e) => trouble.push('error: ' + e.message));"
            "addEventListener('unhandledrejection', (e) => trouble.push('rejection: ' + e.reason));"
            "addEventListener('securitypolicyviolation', (e) => trouble.push('kept out: ' + e.blockedURI));"
            "for (const k of ['error', 'warn']) console[k] = (...a) => trouble.push(k + ': ' + a.join(' '));</script>";
        const std::string tell =
            "<script>setTimeout(() => { trouble.push(...performance.getEntriesByType('resource').map((e) => 'loaded: ' "
            "+ "
            "e.name)); document.body.dataset.trouble = JSON.stringify(trouble); }, 9000);</script>";
        page.insert(page.find("<body>") + 6, watch);
        page.insert(page.rfind("</body>"), "<script>" + script + "</script>" + tell);
        std::ofstream(folder_.path() / "report.html", std::ios::binary) << page;
        const std::string command =
            "timeout 120 " + browser_ + " --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader" +
            " --disable-background-networking --no-first-run --user-data-dir=" + (folder_.path() / "profile").string() +
            ' ' + options + " --window-size=1200,900 --virtual-time-budget=15000 --dump-dom 'file://" +
            (folder_.path() / "report.html").string() + "' 2>/dev/null";
        std::string text;
        FILE* pipe = popen(command.c_str(), "r");
        std::array<char, 65536> buffer;
        for (std::size_t got = 1; pipe != nullptr && (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
            text.append(buffer.data(), got);
        }
        EXPECT_EQ(pclose(pipe), 0) << command;
        return text;
    }

    /// The value of a data- attribute of the body; empty when it has none.
    static std::string told(const std::string& document, const std::string& name) {
        std::smatch match;
        const std::size_t body = document.find("<body");
        const std::string head = document.substr(body, document.find('>', body) - body + 1);
        if (!std::regex_search(head, match, std::regex("data-" + name + "=\"([^\"]*)\""))) {
            return "";
        }
        return std::regex_replace(match[1].str(), std::regex("&quot;"), "\"");
    }

private:
    std::string browser_;
    TestFolder folder_;
};

}  // namespace seampath::test
