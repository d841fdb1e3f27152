#include "pipeline/report_image.hpp"

#include <cmath>

#include "pipeline/report_text.hpp"
#include "pipeline/scan_input.hpp"
#include "stages/picture/picture.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr int kLongestSide = 900;  // px: some 200 kB, a twentieth of what a page may have

/// Means over squares of whole pixels.
GreyImage reduced_for_page(const GreyImage& image) {
    const int by = (std::max(image.width, image.height) + kLongestSide - 1) / kLongestSide;
    GreyImage small{image.width / by, image.height / by, image.white, {}};
    for (int r = 0; r < small.height; ++r) {
        for (int c = 0; c < small.width; ++c) {
            float sum = 0;
            for (int i = 0; i < by * by; ++i) {
                sum += image.at(c * by + i % by, r * by + i / by);
            }
            small.value.push_back(sum / static_cast<float>(by * by));
        }
    }
    return small;
}

ReportImage image_of(const GreyImage& picture, std::string title) {
    ReportImage image;
    image.title = std::move(title);
    image.jpeg = jpeg_bytes(reduced_for_page(picture));
    image.width = picture.width;
    image.height = picture.height;
    return image;
}

/// The line's middle, gaps left open, and the seam's place in its profile.
ReportImage stripe_image(const StripeView& view, const ScanInput& input, const std::vector<Seam>& seams) {
    ReportImage image = image_of(view.image, "Laser stripe, picture " + std::to_string(view.index + 1) + " of " +
                                                 std::to_string(input.profiles.size()));
    image.legend = "Red: the middle of the line as it was measured; ring: where the seam crosses it.";
    double last_column = -INFINITY;
    for (const StripePoint& point : view.stripe.points) {
        if (point.p.x() - last_column > 1.5) {
            image.measured.emplace_back();
        }
        last_column = point.p.x();
        image.measured.back().push_back(point.p);
    }
    if (!seams.empty()) {
        const auto feature = find_seam_point(input.profiles[view.index], input.plane, seams[0].kind);
        if (feature) {
            image.features.push_back(pixel_of(view.camera, feature->p));
        }
    }
    return image;
}

/// Adds the seam's points as polylines of one kind each; a bridged part begins and ends at measured points.
void add_seam(const PhotoView& view, const Seam& seam, ReportImage& image) {
    std::vector<Eigen::Vector2d> line;
    bool bridged = false;
    for (const SeamPoint& point : seam.points) {
        const Eigen::Vector2d p = pixel_of(view.camera, view.camera_from_plane * point.p);
        if (!line.empty() && point.modelled != bridged) {
            const Eigen::Vector2d last = line.back();
            if (bridged) {
                line.push_back(p);
            }
            (bridged ? image.modelled : image.measured).push_back(std::move(line));
            line = {};
            if (!bridged) {
                line.push_back(last);
            }
        }
        bridged = point.modelled;
        line.push_back(p);
    }
    (bridged ? image.modelled : image.measured).push_back(std::move(line));
}

std::string polylines(const std::vector<std::vector<Eigen::Vector2d>>& lines, std::string_view look) {
    std::string svg;
    for (const auto& line : lines) {
        svg += "<polyline fill=\"none\" vector-effect=\"non-scaling-stroke\" " + std::string(look) + " points=\"";
        for (const Eigen::Vector2d& p : line) {
            svg += fixed(p.x() + 0.5, 1) + ',' + fixed(p.y() + 0.5, 1) + ' ';  // SVG counts from a pixel's corner
        }
        svg += "\"/>";
    }
    return svg;
}

std::string rings(const std::vector<Eigen::Vector2d>& points, int width) {
    std::string svg;
    for (const Eigen::Vector2d& p : points) {
        svg +=
            "<circle fill=\"none\" vector-effect=\"non-scaling-stroke\" stroke=\"#ffd000\" stroke-width=\"2\" cx=\"" +
            fixed(p.x() + 0.5, 1) + "\" cy=\"" + fixed(p.y() + 0.5, 1) + "\" r=\"" + fixed(0.012 * width, 1) + "\"/>";
    }
    return svg;
}

}  // namespace

std::vector<ReportImage> report_images(const ScanInput& input, const std::vector<Seam>& seams) {
    if (input.stripe) {
        return {stripe_image(*input.stripe, input, seams)};
    }
    if (!input.photo) {
        return {};
    }
    const PhotoView& view = *input.photo;
    ReportImage image = image_of(view.image, "Photograph");
    image.legend = "Red: the seam as it was measured; dashed: carried over from both sides.";
    for (const Seam& seam : seams) {
        add_seam(view, seam, image);
    }
    return {image};
}

std::string image_section(const std::vector<ReportImage>& images) {
    std::string html;
    for (const ReportImage& image : images) {
        const std::string width = std::to_string(image.width), height = std::to_string(image.height);
        html += "<h2>" + escape_html(image.title) + "</h2><p class=\"soft\">" + width + " × " + height + " pixels. " +
                escape_html(image.legend) +
                "</p><svg "
                "class=\"picture\" role=\"img\" aria-label=\"" +
                escape_html(image.title) + " with the seam\" viewBox=\"0 0 " + width + ' ' + height +
                "\" style=\"max-width:100%;max-height:90vh\"><image width=\"" + width + "\" height=\"" + height +
                "\" preserveAspectRatio=\"none\" href=\"data:image/jpeg;base64," + base64(image.jpeg) + "\"/>" +
                polylines(image.measured, "stroke=\"#ff2d2d\" stroke-width=\"1.5\"") +
                polylines(image.modelled, "stroke=\"#ffd000\" stroke-width=\"1.5\" stroke-dasharray=\"5 4\"") +
                rings(image.features, image.width) + "</svg>\n";
    }
    return html;
}

}  // namespace seampath
