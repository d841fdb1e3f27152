#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/read/read.hpp"

/// Files made in memory, and what must hold for every scan.
namespace seampath::read_test {

inline ReadOptions in_mm() {
    return {.unit = Unit::mm};
}

inline Scan read_string(const std::string& bytes, ScanFormat format, const ReadOptions& options = in_mm()) {
    return read_bytes(std::as_bytes(std::span(bytes)), format, "part", options);
}

/// Message of the InputError that these bytes give; a failure of the test when they give none.
inline std::string error_of(const std::string& bytes, ScanFormat format, const ReadOptions& options = in_mm()) {
    try {
        read_string(bytes, format, options);
    } catch (const InputError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return {};
}

/// The bytes of a number, in little- or big-endian order.
template <class T>
std::string bytes_of(T value, bool big_endian = false) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

template <class... T>
std::string packed(T... values) {
    return (std::string() + ... + bytes_of(values));
}

inline std::vector<Eigen::Vector3d> positions(const Scan& scan) {
    std::vector<Eigen::Vector3d> all;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        all.push_back(scan.position(i));
    }
    return all;
}

/// What types.hpp promises of a scan.
inline void expect_invariants(const Scan& scan) {
    EXPECT_FALSE(scan.points.empty());
    EXPECT_FALSE(scan.format.empty());
    EXPECT_FALSE(scan.unit_reason.empty());
    EXPECT_TRUE(scan.origin_mm.allFinite());
    EXPECT_GT(scan.mm_per_unit, 0);
    EXPECT_LE(scan.dropped_not_finite, scan.points_in_file);
    EXPECT_TRUE(std::all_of(scan.points.begin(), scan.points.end(), [](const auto& p) { return p.allFinite(); }));
    EXPECT_TRUE(scan.normals.empty() || scan.normals.size() == scan.points.size());
    EXPECT_TRUE(std::all_of(scan.normals.begin(), scan.normals.end(),
                            [](const auto& n) { return std::abs(n.norm() - 1) < 1e-5F; }));
    const std::uint64_t raster = std::uint64_t{scan.width} * scan.height;
    EXPECT_EQ(scan.pixel.size(), raster > 0 ? scan.points.size() : 0);
    for (std::size_t i = 0; i < scan.pixel.size(); ++i) {
        ASSERT_LT(scan.pixel[i], raster);
        ASSERT_TRUE(i == 0 || scan.pixel[i - 1] < scan.pixel[i]);
    }
}

}  // namespace seampath::read_test
