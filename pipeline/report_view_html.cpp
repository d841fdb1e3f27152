#include <string>

#include "pipeline/report_text.hpp"
#include "pipeline/report_view.hpp"

namespace seampath {
namespace {

template <class Colours>
std::string colour_bar(const Colours& colours) {
    std::string stops;
    for (const char* colour : colours) {
        stops += std::string(", ") + colour;
    }
    return "<div class=\"bar\" style=\"background:linear-gradient(90deg" + stops + ")\"></div>";
}

std::string bar_ends(const std::string& low, const std::string& middle, const std::string& high) {
    return "<div class=\"ends\"><span>" + low + "</span><span>" + middle + "</span><span>" + high + "</span></div>";
}

/// One legend for distances, one for signed distances; the script shows that of the colours that are on.
std::string legend(const ViewScene& scene) {
    const auto item = [](const std::string& paint, const std::string& text) {
        return "<div class=\"item\"><i style=\"background:" + paint + "\"></i>" + text + "</div>";
    };
    const std::string unchecked =
        item("repeating-linear-gradient(90deg, " + std::string(kUncheckedColour) + " 0 6px, transparent 6px 9px)",
             scene.nominal ? "nominal, not checked against a scan" : "bridged or not checked");
    if (scene.nominal) {
        return "<div id=\"legend\" class=\"overlay\">" + unchecked + "</div>";
    }
    const std::string end = decimal(scene.scale_mm, 3);
    const std::string out = item(kOutOfToleranceColour, "out of tolerance (thicker)") + unchecked;
    return "<div id=\"legend\" class=\"overlay\"><div data-colours=\"distance\"><span class=\"title\">Distance of the "
           "seam "
           "from the scan, mm</span>" +
           colour_bar(kDeviationColours) + bar_ends("0", decimal(scene.scale_mm / 2, 3), end) + out +
           "</div><div data-colours=\"signed\" hidden><span class=\"title\">Signed distance from the flank, mm</span>" +
           colour_bar(kSignedColours) + bar_ends("−" + end, "0", '+' + end) +
           "<div class=\"ends\"><span>− inside material</span><span>+ in the air</span></div>" + unchecked +
           "</div></div>";
}

std::string axes_overlay() {
    std::string svg = "<svg id=\"axes\" class=\"overlay live-only\" viewBox=\"-42 -42 84 84\" aria-hidden=\"true\">";
    for (const std::string name : {"x", "y", "z"}) {
        svg += "<line id=\"axis-" + name + "\" class=\"axis-" + name + "\"/><text id=\"letter-" + name +
               "\" class=\"axis-" + name + "\">" + name + "</text>";
    }
    return svg + "</svg>";
}

std::string toolbar(const ViewScene& scene) {
    const auto layer = [](const std::string& key, const std::string& label) {
        return "<label><input type=\"checkbox\" data-layer=\"" + key + "\" checked> " + label + "</label>";
    };
    const bool seams = !scene.seams.empty(), marks = !scene.marks.empty();
    const bool bare = scene.nominal || (marks && scene.clouds[0].points.empty() && scene.clouds[1].points.empty());
    std::string html = "<div class=\"toolbar\">" + (bare ? std::string() : layer("scan", "Scan"));
    if (marks) {
        html += layer("marks", "Features") + layer("ellipsoids", "Uncertainty");
    }
    if (seams) {
        html += layer("seam", "Seams") + (scene.nominal ? "" : layer("nodes", "Nodes")) + layer("torch", "Torch");
    }
    if (seams && !scene.nominal) {
        html +=
            "<label>Colours <select id=\"colours\"><option value=\"distance\">distance</option><option "
            "value=\"flank1\">from flank 1, signed</option><option value=\"flank2\">from flank 2, "
            "signed</option></select></label>";
    }
    return html +
           "<button type=\"button\" id=\"fit\">Fit view</button><span id=\"view-note\">Drag or arrow keys turn, Shift "
           "or "
           "right button moves, wheel, pinch or + and − zoom" +
           (seams ? "; a click on a seam shows the section there" : "") + "</span></div>";
}

}  // namespace

std::string view_section(const ViewScene& scene) {
    return "<section aria-label=\"3D view\"><div id=\"view\">" + view_svg(scene) + axes_overlay() +
           (scene.seams.empty() ? "" : legend(scene)) +
           "<div id=\"scale-bar\" class=\"overlay live-only\"></div><div id=\"tip\" class=\"overlay\" "
           "hidden></div></div>" +
           toolbar(scene) +
           "<noscript><p class=\"note-line\">Scripts are off: this is a still picture, and there are no "
           "sections.</p></noscript></section>\n";
}

}  // namespace seampath
