#include "datasets/sensor_errors.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"
#include "datasets/rows.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using portable::radians;

constexpr double kMostDropout = 0.95;  // share of missing pixels at grazing incidence

std::vector<double> gaussian_kernel(double sigma) {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> kernel;
    double power = 0;
    for (int i = -reach; i <= reach; ++i) {
        kernel.push_back(sigma > 0 ? portable::exp(-i * i / (2 * sigma * sigma)) : 1);
        power += kernel.back() * kernel.back();
    }
    for (double& weight : kernel) {
        weight /= std::sqrt(power);  // independent values of variance 1 keep variance 1
    }
    return kernel;
}

}  // namespace

std::vector<double> noise_field(const ScannerOptions& o, const Station& station, const Random& random,
                                unsigned threads) {
    const std::vector<double> across = gaussian_kernel(o.correlation_px);
    const std::vector<double> down = gaussian_kernel(o.sensor == SensorKind::camera ? o.correlation_px : 0);
    const std::size_t width = station.width;
    const std::size_t white_width = width + across.size() - 1;
    const auto rows = static_cast<std::uint32_t>(station.height + down.size() - 1);
    std::vector<double> blurred(rows * width);
    for_rows(rows, threads, [&](std::uint32_t row) {
        std::vector<double> white(white_width);
        for (std::size_t i = 0; i < white_width; ++i) {
            white[i] = random.normal(row * white_width + i);
        }
        for (std::size_t column = 0; column < width; ++column) {
            double sum = 0;
            for (std::size_t k = 0; k < across.size(); ++k) {
                sum += across[k] * white[column + k];
            }
            blurred[row * width + column] = sum;
        }
    });
    std::vector<double> field(station.height * width);
    for_rows(station.height, threads, [&](std::uint32_t row) {
        for (std::size_t k = 0; k < down.size(); ++k) {
            for (std::size_t column = 0; column < width; ++column) {
                field[row * width + column] += down[k] * blurred[(row + k) * width + column];
            }
        }
    });
    return field;
}

std::vector<char> blob_mask(const ScannerOptions& o, const Station& station, const Random& random) {
    const double kMeanArea = portable::kPi * (2.5 * 2.5 * 2.5 - 0.5 * 0.5 * 0.5) / (3 * (2.5 - 0.5));  // mm^2
    const double area = station.width * o.pitch_x_mm * station.height * o.pitch_y_mm;
    const auto spots = static_cast<std::uint64_t>(o.blobs * area / kMeanArea);
    std::vector<char> mask(std::size_t{station.width} * station.height);
    for (std::uint64_t i = 0; i < spots; ++i) {
        const double column = random.uniform(3 * i, 0, station.width);
        const double row = random.uniform(3 * i + 1, 0, station.height);
        const double radius = random.uniform(3 * i + 2, 0.5, 2.5);
        const double reach_x = radius / o.pitch_x_mm;
        const double reach_y = radius / o.pitch_y_mm;
        for (double r = std::max(0.0, std::ceil(row - reach_y)); r <= std::min(station.height - 1.0, row + reach_y);
             ++r) {
            for (double c = std::max(0.0, std::ceil(column - reach_x));
                 c <= std::min(station.width - 1.0, column + reach_x); ++c) {
                const double dx = (c - column) / reach_x;
                const double dy = (r - row) / reach_y;
                if (dx * dx + dy * dy <= 1) {
                    mask[static_cast<std::size_t>(r) * station.width + static_cast<std::size_t>(c)] = 1;
                }
            }
        }
    }
    return mask;
}

double dropout_share(double p0, double cosine) {
    const double t = std::clamp((portable::acos(cosine) - radians(60)) / radians(20), 0.0, 1.0);
    return p0 + std::max(0.0, kMostDropout - p0) * t * t * (3 - 2 * t);
}

Vector3d path_error(const ScannerOptions& o, const Random& random, std::uint32_t row) {
    Vector3d error = Vector3d::Zero();
    for (std::uint64_t i = 0; i < 9 && o.path_error_mm > 0; ++i) {
        const double wavelength = random.uniform(2 * i, 20, 300);
        const double phase = random.uniform(2 * i + 1, 0, 2 * portable::kPi);
        error[static_cast<int>(i % 3)] +=
            o.path_error_mm / 3 * portable::sin(phase + 2 * portable::kPi * row * o.pitch_y_mm / wavelength);
    }
    return error;
}

}  // namespace seampath
