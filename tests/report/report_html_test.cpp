#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "pipeline/report.hpp"
#include "tests/report/example_part.hpp"

namespace seampath::test {
namespace report_html_test {

using Json = nlohmann::json;

/// Row of report.json at a path such as "seams.0.length_mm" or "scan.noise_mm".
Json row_at(const Json& report, const std::string& path) {
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
bool holds(const std::string& page, std::string_view text) {
    return page.find(text) != std::string::npos;
}

std::string without_groups(std::string text) {
    for (std::size_t at = text.find("\u202f"); at != std::string::npos; at = text.find("\u202f")) {
        text.erase(at, std::string("\u202f").size());
    }
    return text;
}

/// What a page shows at each data-row is the value there in report.json, rounded to the places that are shown.
/// Returns how many numbers were compared.
int expect_numbers_equal(const std::string& page, const Json& report) {
    const std::regex cell("data-row=\"([^\"]+)\" data-value=\"([^\"]*)\">([^<]*)<");
    int numbers = 0;
    for (std::sregex_iterator it(page.begin(), page.end(), cell), end; it != end; ++it) {
        const Json value = row_at(report, (*it)[1]).at("value");
        if (!value.is_number()) {
            continue;
        }
        ++numbers;
        EXPECT_EQ(std::stod((*it)[2]), value.get<double>()) << it->str();
        const std::string text = without_groups((*it)[3]);
        if (text.starts_with("&lt;")) {
            EXPECT_LT(std::abs(value.get<double>()), std::stod(text.substr(4)));
            continue;
        }
        const std::size_t point = text.find('.');
        const double place =
            point == std::string::npos ? 1 : std::pow(10, -static_cast<double>(text.size() - point - 1));
        EXPECT_NEAR(std::stod(text), value.get<double>(), 0.5000001 * place) << it->str();
    }
    return numbers;
}

TEST(ReportHtml, ShowsTheNumbersOfReportJson) {
    const PartResult part = example_part();
    EXPECT_GT(expect_numbers_equal(report_html(part), Json::parse(report_json(part))), 80);
}

TEST(ReportHtml, CarriesReportJsonWhole) {
    const PartResult part = example_part();
    const std::string page = report_html(part), open = "<script type=\"application/json\" id=\"report\">";
    const std::size_t from = page.find(open);
    ASSERT_NE(from, std::string::npos);
    const std::string inside = page.substr(from + open.size(), page.find("</script>", from) - from - open.size());
    EXPECT_EQ(Json::parse(inside), Json::parse(report_json(part)));
}

TEST(ReportHtml, NeedsNothingFromOutside) {
    const std::string page = report_html(example_part());
    EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"")));
    EXPECT_FALSE(holds(page, "@import"));
}

TEST(ReportHtml, NamesCanNotBreakOut) {
    PartResult part = example_part();
    part.scan.name = "</title><script>alert(1)</script>";
    part.extraction.remarks = {"</script><img onerror=x>"};
    part.programs[0].file_name = "\"><u>";
    part.deviations[0].verdict = "<i>";
    const std::string page = report_html(part);
    for (const char* evil : {"<script>alert", "<img onerror", "\"><u>", "<i>"}) {
        EXPECT_FALSE(holds(page, evil)) << evil;
    }
    EXPECT_TRUE(holds(page, "&lt;script&gt;alert(1)"));
}

TEST(ReportHtml, MarksSettingsThatWereChanged) {
    const std::string page = report_html(example_part());
    EXPECT_TRUE(std::regex_search(page, std::regex("<tr class=\"changed\"><td class=\"code\">validate.min_coverage<")));
    EXPECT_TRUE(std::regex_search(page, std::regex("<tr><td class=\"code\">plan.speed_mm_s<")));
}

TEST(ReportHtml, SaysSoWhenNothingWasFound) {
    const std::string page = report_html(part_without_seams());
    EXPECT_TRUE(holds(page, "data-verdict=\"fail\""));
    EXPECT_TRUE(holds(page, "No seam was found in this scan"));
    EXPECT_TRUE(holds(page, "None was written."));
    EXPECT_TRUE(holds(page, "<li>only one surface was found</li>"));
}

TEST(ReportHtml, IsTheSameTwice) {
    EXPECT_EQ(report_html(example_part()), report_html(example_part()));
}

// ---------------------------------------------------------------------------------------------- in a real browser

/// Opens pages in headless Chromium, drawing in software.
class ReportInBrowser : public testing::Test {
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
        std::string pattern = (std::filesystem::temp_directory_path() / "seampath-report-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }

    void TearDown() override {
        if (!folder_.empty()) {
            std::filesystem::remove_all(folder_);
        }
    }

    /// The document after its scripts have run. `hash` is the part of the address after the file, `options` more for
    /// the browser.
    std::string dom(const std::string& page, const std::string& hash = "", const std::string& options = "") {
        std::ofstream(folder_ / "report.html", std::ios::binary) << page;
        const std::string profile = (folder_ / "profile").string();
        const std::string command =
            "timeout 120 " + browser_ + " --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader" +
            " --disable-background-networking --no-first-run --user-data-dir=" + profile + ' ' + options +
            " --window-size=1200,900 --virtual-time-budget=15000 --dump-dom 'file://" +
            (folder_ / "report.html").string() + hash + "' 2>/dev/null";
        std::string text;
        FILE* pipe = popen(command.c_str(), "r");
        std::array<char, 65536> buffer;
        for (std::size_t got = 1; pipe != nullptr && (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
            text.append(buffer.data(), got);
        }
        EXPECT_EQ(pclose(pipe), 0) << command;
        return text;
    }

    /// Share of the canvas that was drawn on, as the page itself read it back; -1 when it says nothing.
    static double coverage(const std::string& document) {
        std::smatch match;
        return std::regex_search(document, match, std::regex("data-canvas-coverage=\"([0-9.]+)\""))
                   ? std::stod(match[1])
                   : -1;
    }

    std::filesystem::path folder_;
    std::string browser_;
};

TEST_F(ReportInBrowser, DrawsTheSceneAndShowsTheNumbersOfReportJson) {
    const PartResult part = example_part();
    const std::string page = report_html(part);
    const std::string document = dom(page);
    EXPECT_FALSE(holds(document, "data-canvas-error"));
    EXPECT_GT(coverage(document), 0.3);
    EXPECT_GT(expect_numbers_equal(document, Json::parse(report_json(part))), 80);

    const double no_scan = coverage(dom(page, "#hide=scan"));
    EXPECT_GT(no_scan, 0.005);
    EXPECT_LT(no_scan, 0.2);
    EXPECT_LT(coverage(dom(page, "#hide=scan,torch,nodes")), 0.8 * no_scan);
    EXPECT_EQ(coverage(dom(page, "#hide=scan,seam,torch,nodes")), 0);
}

TEST_F(ReportInBrowser, DrawsAScanWithoutSeams) {
    EXPECT_GT(coverage(dom(report_html(part_without_seams()))), 0.2);
}

TEST_F(ReportInBrowser, KeepsTheStillPictureWithoutWebGl) {
    const std::string document = dom(report_html(example_part()), "", "--disable-3d-apis");
    EXPECT_TRUE(holds(document, "data-canvas-error"));
    EXPECT_TRUE(holds(document, "this is a still picture"));
    EXPECT_FALSE(holds(document, "class=\"live\""));
}

}  // namespace report_html_test
}  // namespace seampath::test
