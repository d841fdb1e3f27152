#include <gtest/gtest.h>

#include "pipeline/parts_page.hpp"
#include "pipeline/report.hpp"
#include "pipeline/report_sections.hpp"
#include "tests/report/example_part.hpp"
#include "tests/report/page.hpp"

namespace seampath::test {
namespace report_browser_test {

using ReportInBrowser = InBrowser;

/// Waits for the 3D view, then uses the page as a person would and tells in data-probe what it showed.
constexpr const char* kUse = R"js(
(async () => {
  const body = document.body, probe = {};
  while (!body.dataset.canvasMilliseconds) await new Promise((done) => setTimeout(done, 20));
  const coverage = () => Number(body.dataset.canvasCoverage);
  const toggle = (layer) => { document.querySelector(`[data-layer="${layer}"]`).click(); return coverage(); };
  probe.all = coverage();
  probe.noScan = toggle('scan');
  toggle('torch');
  probe.seamsOnly = toggle('nodes');
  probe.nothing = toggle('seam');
  probe.seamsAgain = toggle('seam');

  const colours = document.getElementById('colours');
  const legends = () => [...document.querySelectorAll('[data-colours]')].map((legend) => !legend.hidden);
  probe.legends = legends();
  colours.value = 'flank1';
  colours.dispatchEvent(new Event('change'));
  probe.legendsSigned = legends();

  const panel = document.querySelector('#seam-1 figure.section');
  const look = () => ({ station: Number(panel.dataset.station), note: panel.querySelector('output').textContent,
    points: panel.querySelector('.measured').getAttribute('d').split('M').length - 1,
    traces: panel.querySelectorAll('.trace').length, marks: document.querySelectorAll('#seam-1 .here').length });
  probe.worst = look();
  const svg = document.querySelector('#seam-1 .wide.by-station svg'), box = svg.getBoundingClientRect();
  const [left, right, low, high] = svg.dataset.plot.split(' ').map(Number);
  const x = left + (30 - low) / (high - low) * (right - left);
  svg.dispatchEvent(new MouseEvent('click', { bubbles: true,
    clientX: box.left + x / svg.viewBox.baseVal.width * box.width, clientY: box.top + 20 }));
  probe.clicked = look();
  const slider = panel.querySelector('input');
  slider.value = slider.max;
  slider.dispatchEvent(new Event('input'));
  probe.last = look();
  document.querySelectorAll('#seam-1 button.place')[1].click();
  probe.place = look();

  const canvas = document.querySelector('#view canvas');
  const axis = () => document.getElementById('axis-x').getAttribute('x2');
  const before = axis();
  canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }));
  await new Promise((done) => setTimeout(done, 200));
  probe.turned = axis() !== before;
  probe.unlabelled = [...document.querySelectorAll('input, select, button, canvas, svg[role=img]')]
    .filter((e) => !(e.getAttribute('aria-label') || e.closest('label') || e.textContent.trim())).length;
  body.dataset.probe = JSON.stringify(probe);
})();
)js";

/// The section nearest to a station is the one that is shown, with the numbers of its sample.
void expect_section(const Json& shown, const SeamSections& seam, double station) {
    const auto nearest =
        std::min_element(seam.sections.begin(), seam.sections.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.sample.station_mm - station) < std::abs(b.sample.station_mm - station);
        });
    EXPECT_NEAR(shown.at("station").get<double>(), nearest->sample.station_mm, 1e-9);
    EXPECT_EQ(shown.at("points"), nearest->points.size());
    EXPECT_EQ(shown.at("traces"), 2);
    EXPECT_GE(shown.at("marks"), 3);
    std::smatch match;
    const std::string note = shown.at("note");
    ASSERT_TRUE(std::regex_search(note, match, std::regex("deviation ([0-9.]+) ± ([0-9.]+) mm"))) << note;
    expect_shown(match[1], nearest->sample.distance_mm, note);
    expect_shown(match[2], nearest->sample.sigma_mm, note);
}

TEST_F(ReportInBrowser, ShowsLayersSectionsAndTheNumbersOfReportJson) {
    const PartResult part = example_part();
    const Json report = Json::parse(report_json(part));
    const std::string document = dom(report_html(part), kUse);
    EXPECT_EQ(told(document, "trouble"), "[]");
    EXPECT_EQ(told(document, "canvas-error"), "");
    EXPECT_GT(expect_numbers_equal(document, report), 120);
    ASSERT_NE(told(document, "probe"), "");
    const Json probe = Json::parse(told(document, "probe"));

    EXPECT_GT(probe.at("all"), 0.3);
    EXPECT_GT(probe.at("noScan"), 0.005);
    EXPECT_LT(probe.at("noScan"), 0.2);
    EXPECT_LT(probe.at("seamsOnly"), 0.8 * probe.at("noScan").get<double>());
    EXPECT_EQ(probe.at("nothing"), 0);
    EXPECT_EQ(probe.at("seamsAgain"), probe.at("seamsOnly"));
    EXPECT_EQ(probe.at("legends"), Json({true, false}));
    EXPECT_EQ(probe.at("legendsSigned"), Json({false, true}));
    EXPECT_EQ(probe.at("turned"), true);
    EXPECT_EQ(probe.at("unlabelled"), 0);

    const SeamSections sections = seam_sections(part).at(1);
    const Json& places = report.at("seams")[1].at("worst_places");
    expect_section(probe.at("worst"), sections, places[0].at("station_mm"));
    expect_section(probe.at("clicked"), sections, 30);
    expect_section(probe.at("last"), sections, 1e9);
    expect_section(probe.at("place"), sections, places[1].at("station_mm"));
}

TEST_F(ReportInBrowser, DrawsAScanWithoutSeams) {
    const std::string document = dom(report_html(part_without_seams()));
    EXPECT_EQ(told(document, "trouble"), "[]");
    EXPECT_GT(std::stod("0" + told(document, "canvas-coverage")), 0.2);
}

TEST_F(ReportInBrowser, KeepsTheStillPictureAndTheSectionsWithoutWebGl) {
    const std::string document = dom(report_html(example_part()), "", "--disable-3d-apis");
    EXPECT_NE(told(document, "canvas-error"), "");
    EXPECT_TRUE(holds(document, "this is a still picture"));
    EXPECT_FALSE(holds(document, "class=\"live\""));
    EXPECT_TRUE(holds(document, "class=\"measured\""));
}

}  // namespace report_browser_test
}  // namespace seampath::test
