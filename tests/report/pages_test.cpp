#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/line_picture.hpp"
#include "pipeline/parts_page.hpp"
#include "pipeline/report.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/report/example_part.hpp"
#include "tests/report/page.hpp"

/// The summary over many parts, and the report on paper.
namespace seampath::test {
namespace pages_test {

using testing::HasSubstr;

PartRow row(const std::string& name, bool pass, double tolerance_used) {
    PartRow made = part_row(example_part());
    made.name = made.folder = name;
    made.pass = pass;
    made.tolerance_used = tolerance_used;
    return made;
}

/// Names of the parts in the order of the page.
std::vector<std::string> order(const std::string& page) {
    std::vector<std::string> names;
    const std::regex name("<th scope=\"row\">(?:<a href=\"([^\"]*)\">)?([^<]*)");
    for (std::sregex_iterator it(page.begin(), page.end(), name), end; it != end; ++it) {
        names.push_back((*it)[2]);
        EXPECT_TRUE((*it)[1].length() == 0 || (*it)[1] == (*it)[2].str() + "/report.html");
    }
    return names;
}

std::vector<PartRow> four_parts() {
    PartRow broken;
    broken.name = broken.folder = "broken";
    return {row("good", true, 0.3), row("bad", false, 2.5), row("tight", true, 0.9), broken};
}

TEST(PartsPage, NamesTheWorstFirst) {
    const std::string page = parts_page(four_parts());
    EXPECT_EQ(order(page), (std::vector<std::string>{"broken", "bad", "tight", "good"}));
    EXPECT_TRUE(holds(page, "2 of 4 parts pass"));
}

TEST(PartsPage, ARowHasTheNumbersOfItsPart) {
    const PartResult part = example_part();
    const PartRow made = part_row(part);
    EXPECT_NEAR(made.length_mm, part.models[0].length_mm + part.models[1].length_mm, 1e-9);
    EXPECT_EQ(made.deviation_max_mm, std::max(part.deviations[0].max_mm, part.deviations[1].max_mm));
    EXPECT_NEAR(made.coverage, (0.981 * part.models[0].length_mm + part.models[1].length_mm) / made.length_mm, 1e-12);
    EXPECT_TRUE(made.pass);
    EXPECT_TRUE(part_row(part_without_seams()).picture.starts_with("<svg"));
    EXPECT_EQ(part_row(part_without_seams()).coverage, 0);
}

TEST(LinePicture, ShowsAFlatFigureAtOneScaleAndInside) {
    // A rectangle of 40 by 20 in a plane that no axis lies in.
    const Eigen::Vector3d u = Eigen::Vector3d(1, 2, 2) / 3, v = Eigen::Vector3d(2, 1, -2) / 3, o(100, -50, 7);
    const PictureLine line{{o, o + 40 * u, o + 40 * u + 20 * v, o + 20 * v}, "good"};
    const std::string svg = line_picture({&line, 1}, 212, 112, "t");
    std::vector<Eigen::Vector2d> shown;
    const std::regex point("[ML]([0-9.]+) ([0-9.]+)");
    for (std::sregex_iterator it(svg.begin(), svg.end(), point), end; it != end; ++it) {
        shown.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
    }
    ASSERT_EQ(shown.size(), 4U);
    EXPECT_NEAR((shown[1] - shown[0]).norm(), 200, 0.2);  // 212 less the margins: 5 px a mm
    EXPECT_NEAR((shown[2] - shown[1]).norm(), 100, 0.2);
    for (const Eigen::Vector2d& p : shown) {
        EXPECT_GT(p.x(), 5);
        EXPECT_LT(p.x(), 207);
    }
}

using PagesInBrowser = InBrowser;

TEST_F(PagesInBrowser, TheSummarySortsByTheHeadingThatIsClicked) {
    const std::string document = dom(parts_page(four_parts()), R"js(
        const button = (text) => [...document.querySelectorAll('th button')].find((b) => b.textContent.startsWith(text));
        const names = () => [...document.querySelectorAll('tbody th')].map((cell) => cell.textContent).join(' ');
        const seen = [];
        for (const text of ['Tolerance', 'Tolerance', 'Part', 'Part']) { button(text).click(); seen.push(names()); }
        document.body.dataset.orders = JSON.stringify(seen);)js");
    EXPECT_EQ(told(document, "trouble"), "[]");
    EXPECT_EQ(Json::parse(told(document, "orders")), Json({"bad tight good broken", "good tight bad broken",
                                                           "bad broken good tight", "tight good broken bad"}));
}

TEST_F(PagesInBrowser, TheReportPrintsToAPdf) {
    const TestFolder folder;
    std::ofstream(folder.path() / "report.json") << report_json(example_part());
    std::ofstream(folder.path() / "report.html") << report_html(example_part());
    const Outcome run = Process({"report", folder.path().string(), "--pdf"}).wait();
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("deviation_p997_mm"));
    const std::string pdf = text_of(folder.path() / "report.pdf");
    const std::regex page("/Type */Page[^s]");
    const auto pages = std::distance(std::sregex_iterator(pdf.begin(), pdf.end(), page), std::sregex_iterator());
    EXPECT_GE(pages, 2);
    EXPECT_LE(pages, 8);
    EXPECT_TRUE(std::regex_search(pdf, std::regex("/MediaBox *\\[0 0 59[45][.0-9]* 84[12]")));  // A4
}

TEST(ReportCommand, SaysWhatIsMissing) {
    const TestFolder folder;
    const Outcome none = Process({"report", folder.path().string()}).wait();
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.err, HasSubstr("has no report.json; a folder that \"seampath run\" wrote was needed"));
    std::ofstream(folder.path() / "report.json") << report_json(example_part());
    std::ofstream(folder.path() / "report.html") << "page";
    const Outcome bare = Process({"report", folder.path().string(), "--pdf"}, [] { setenv("PATH", "", 1); }).wait();
    EXPECT_EQ(bare.status, 2);
    EXPECT_THAT(bare.err, HasSubstr("no browser to print with was found"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.pdf"));
}

}  // namespace pages_test
}  // namespace seampath::test
