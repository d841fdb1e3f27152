#include "stages/photo/path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace seampath::detail {
namespace {

// Sigmas. What texture gives at its best over all widths and slopes is no sign of a line; and beyond what a line that
// nobody doubts has, more says no more.
constexpr float kTexture = 1;
constexpr float kClear = 5.5F;
constexpr float kBendCharge = 4;    // for a bend of 1 / kSlopes: that of a block of the clearest line
constexpr float kChangeCharge = 4;  // from dark to bright or back
constexpr float kNever = -std::numeric_limits<float>::infinity();

class PathSearch {
public:
    PathSearch(const LineEvidence& evidence, std::span<const LineKind> kinds)
        : evidence_(evidence),
          kinds_(kinds),
          rows_(evidence.rows()),
          end_(rows_),
          states_(kinds.size() * kSlopeCount * static_cast<std::size_t>(rows_)),
          worth_(states_, 0) {}

    LinePath run(std::span<const LinePath> taken, const Corridor* corridor) {
        const int blocks = evidence_.blocks();
        from_.assign(static_cast<std::size_t>(blocks) * states_, 0);
        for (int b = 0; b < blocks; ++b) {
            if (corridor) {
                const auto i = static_cast<std::size_t>(b);
                const double reach = Corridor::kShare * corridor->half[i];
                begin_ = std::max(0, static_cast<int>(std::ceil(corridor->middle[i] - reach)));
                end_ = std::min(rows_, static_cast<int>(std::floor(corridor->middle[i] + reach)) + 1);
            }
            if (b > 0) {
                advance(&from_[static_cast<std::size_t>(b) * states_]);
            }
            add_gains(b, charges(b, corridor), free_rows(b, taken));
        }
        return trace();
    }

private:
    std::size_t index(std::size_t kind, int slope) const {
        return (kind * kSlopeCount + static_cast<std::size_t>(slope + kSlopes)) * static_cast<std::size_t>(rows_);
    }

    /// Moves each state on by its slope, from the best of those whose slope is a step away at most. `from` is told
    /// which: 3 times its kind, plus the step, plus 1.
    void advance(std::uint8_t* from) {
        std::vector<float> next(states_, kNever);
        for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
            for (int s = -kSlopes; s <= kSlopes; ++s) {
                for (std::size_t old_kind = 0; old_kind < kinds_.size(); ++old_kind) {
                    for (int bend = -1; bend <= 1; ++bend) {
                        if (std::abs(s + bend) <= kSlopes) {
                            const float charge = kBendCharge * static_cast<float>(std::abs(bend)) +
                                                 (old_kind == kind ? 0 : kChangeCharge);
                            const auto code =
                                static_cast<std::uint8_t>(3 * old_kind + static_cast<std::size_t>(bend + 1));
                            move_on(&worth_[index(old_kind, s + bend)], s + bend, charge, code, &next[index(kind, s)],
                                    from + index(kind, s));
                        }
                    }
                }
            }
        }
        worth_ = std::move(next);
    }

    void move_on(const float* old, int rows_down, float charge, std::uint8_t code, float* __restrict next,
                 std::uint8_t* __restrict from) const {
        for (int r = std::max(begin_, rows_down); r < std::min(end_, rows_ + rows_down); ++r) {
            const float worth = old[r - rows_down] - charge;
            const bool better = worth > next[r];
            next[r] = better ? worth : next[r];
            from[r] = better ? code : from[r];
        }
    }

    /// What is taken off each row's worth.
    std::vector<float> charges(int block, const Corridor* corridor) const {
        std::vector<float> less(static_cast<std::size_t>(rows_), 0);
        for (int r = begin_; corridor && r < end_; ++r) {
            const auto b = static_cast<std::size_t>(block);
            const double off = (r - corridor->middle[b]) / corridor->half[b];
            less[static_cast<std::size_t>(r)] = static_cast<float>(Corridor::kCharge * off * off);
        }
        return less;
    }

    /// 1, or 0 for the rows of a line that is taken, and of its sides.
    std::vector<float> free_rows(int block, std::span<const LinePath> taken) const {
        constexpr int kLeastApart = 4;
        std::vector<float> free(static_cast<std::size_t>(rows_), 1);
        for (const LinePath& path : taken) {
            const PathPlace& place = path.places[static_cast<std::size_t>(block)];
            const int reach = kLeastApart + static_cast<int>(place.sign.width);
            for (int r = std::max(0, place.row - reach); r <= std::min(rows_ - 1, place.row + reach); ++r) {
                free[static_cast<std::size_t>(r)] = 0;
            }
        }
        return free;
    }

    void add_gains(int block, const std::vector<float>& less, const std::vector<float>& free) {
        for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
            for (int s = -kSlopes; s <= kSlopes; ++s) {
                const LineSign* signs = evidence_.at(kinds_[kind], block, s);
                float* worth = &worth_[index(kind, s)];
                for (int r = 0; r < rows_; ++r) {
                    const auto i = static_cast<std::size_t>(r);
                    if (r < begin_ || r >= end_) {
                        worth[r] = kNever;
                        continue;
                    }
                    worth[r] += free[i] * std::clamp(signs[r].strength - kTexture, 0.0F, kClear - kTexture) - less[i];
                }
            }
        }
    }

    LinePath trace() const {
        const auto best = std::max_element(worth_.begin(), worth_.end());
        const int blocks = evidence_.blocks();
        LinePath path{{}, *best / std::max(1, blocks)};
        auto state = static_cast<std::size_t>(best - worth_.begin());
        const auto rows = static_cast<std::size_t>(rows_);
        std::size_t kind = state / rows / kSlopeCount;
        int slope = static_cast<int>(state / rows % kSlopeCount) - kSlopes, row = static_cast<int>(state % rows);
        for (int b = blocks - 1; b >= 0; --b) {
            path.places.push_back({row, slope, kinds_[kind], evidence_.at(kinds_[kind], b, slope)[row]});
            const int code =
                from_[static_cast<std::size_t>(b) * states_ + index(kind, slope) + static_cast<std::size_t>(row)];
            kind = static_cast<std::size_t>(code / 3);
            slope += code % 3 - 1;
            row -= slope;
        }
        std::reverse(path.places.begin(), path.places.end());
        return path;
    }

    const LineEvidence& evidence_;
    std::span<const LineKind> kinds_;
    int rows_, begin_ = 0, end_;  ///< begin, end: of the rows that a path may take in the block at work
    std::size_t states_;
    std::vector<float> worth_;
    std::vector<std::uint8_t> from_;  ///< states of each block
};

}  // namespace

LinePath best_path(const LineEvidence& evidence, std::span<const LineKind> kinds, std::span<const LinePath> taken,
                   const Corridor* corridor) {
    return PathSearch(evidence, kinds).run(taken, corridor);
}

}  // namespace seampath::detail
