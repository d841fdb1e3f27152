#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/report.hpp"
#include "tests/report/example_part.hpp"
#include "tests/report/page.hpp"

namespace seampath::test {
namespace report_html_test {

using Json = nlohmann::json;

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

TEST(ReportHtml, NeedsNothingFromOutsideAndLinksToTheProgramsBesideIt) {
    PartResult part = example_part();
    part.programs[0].file_name = "a b#1.mod";
    const std::string page = report_html(part);
    EXPECT_FALSE(std::regex_search(page, std::regex("src=\"")));
    EXPECT_FALSE(holds(page, "@import"));
    EXPECT_TRUE(holds(page, "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';"));
    const std::regex link("href=\"([^\"]*)\"");
    std::vector<std::string> links;
    for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it) {
        links.push_back((*it)[1]);
    }
    EXPECT_EQ(links, (std::vector<std::string>{"programs/abb/a%20b%231.mod", "programs/ur/seampath.script"}));
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

}  // namespace report_html_test
}  // namespace seampath::test
