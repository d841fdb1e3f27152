#pragma once

#include <cmath>
#include <cstdint>

#include "datasets/portable_math.hpp"

namespace seampath {

/// Random numbers by counter: number i of a stream is a hash of (seed, stream, i), so that it is the same whatever was
/// drawn before, on any thread and any machine. The hash is the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
class Random {
public:
    Random(std::uint64_t seed, std::uint64_t stream) : key_(mix(mix(seed) + stream * kGolden)) {}

    std::uint64_t bits(std::uint64_t i) const { return mix(mix(key_ + i * kGolden) ^ key_); }

    /// In (0, 1), both ends left out.
    double uniform(std::uint64_t i) const { return (static_cast<double>(bits(i) >> 12) + 0.5) * 0x1p-52; }
    double uniform(std::uint64_t i, double low, double high) const { return low + (high - low) * uniform(i); }

    /// Mean 0, variance 1 (Box and Muller).
    double normal(std::uint64_t i) const {
        const double r = std::sqrt(-2 * portable::log(uniform(2 * i)));
        return r * portable::cos(2 * portable::kPi * uniform(2 * i + 1));
    }

private:
    static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;  // 2^64 / golden ratio
    static std::uint64_t mix(std::uint64_t z) {
        z += kGolden;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }

    std::uint64_t key_;
};

}  // namespace seampath
