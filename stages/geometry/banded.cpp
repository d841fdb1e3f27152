#include "stages/geometry/banded.hpp"

#include <algorithm>

namespace seampath {

BandedMatrix::BandedMatrix(std::size_t n, bool cyclic)
    : n_(n), cyclic_(cyclic), width_(std::min<std::size_t>(n, cyclic ? 7 : 4)), value_(n * width_, 0) {}

void BandedMatrix::add_square(const Four& unknown, const Values& v, double factor) {
    const Four k{fold(unknown[0]), fold(unknown[1]), fold(unknown[2]), fold(unknown[3])};
    for (int r = 0; r < 4; ++r) {
        for (int c = 0; c <= r; ++c) {
            at(std::max(k[r], k[c]), std::min(k[r], k[c])) += factor * v[r] * v[c];
        }
    }
}

double BandedMatrix::square(const Four& unknown, const Values& v) const {
    const Four k{fold(unknown[0]), fold(unknown[1]), fold(unknown[2]), fold(unknown[3])};
    double sum = 0;
    for (int r = 0; r < 4; ++r) {
        sum += v[r] * v[r] * at(k[r], k[r]);
        for (int c = 0; c < r; ++c) {
            sum += 2 * v[r] * v[c] * at(std::max(k[r], k[c]), std::min(k[r], k[c]));
        }
    }
    return sum;
}

double BandedMatrix::mean_diagonal() const {
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) {
        sum += at(i, i);
    }
    return sum / static_cast<double>(n_);
}

double BandedMatrix::trace_with(const BandedMatrix& other) const {
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) {
        const double* a = &value_[i * width_];
        const double* b = &other.value_[i * width_];
        for (std::size_t k = 0; k + 1 < width_; ++k) {
            sum += 2 * a[k] * b[k];
        }
        sum += a[width_ - 1] * b[width_ - 1];
    }
    return sum;
}

bool BandedMatrix::factorise() {
    constexpr double kPivotRounding = 1e-15;
    for (std::size_t i = 0; i < n_; ++i) {
        const std::size_t first = first_in_row(i);
        const double before = at(i, i);
        double* row = &at(i, first);
        for (std::size_t j = first; j < i; ++j) {  // L_ij D_j
            const double* other = &at(j, first);
            double sum = row[j - first];
            for (std::size_t k = 0; k < j - first; ++k) {
                sum -= row[k] * other[k];
            }
            row[j - first] = sum;
        }
        double pivot = before;
        for (std::size_t j = first; j < i; ++j) {
            const double scaled = row[j - first] / at(j, j);
            pivot -= scaled * row[j - first];
            row[j - first] = scaled;
        }
        if (!(pivot > kPivotRounding * before)) {
            return false;
        }
        at(i, i) = pivot;
    }
    return true;
}

std::vector<Eigen::RowVector3d> BandedMatrix::solve(const std::vector<Eigen::RowVector3d>& right) const {
    std::vector<Eigen::RowVector3d> x(n_);
    for (std::size_t i = 0; i < n_; ++i) {
        x[fold(i)] = right[i];
    }
    for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = first_in_row(i); j < i; ++j) {
            x[i] -= at(i, j) * x[j];
        }
    }
    for (std::size_t i = n_; i-- > 0;) {
        x[i] /= at(i, i);
    }
    for (std::size_t i = n_; i-- > 0;) {
        for (std::size_t j = first_in_row(i); j < i; ++j) {
            x[j] -= at(i, j) * x[i];
        }
    }
    std::vector<Eigen::RowVector3d> result(n_);
    for (std::size_t i = 0; i < n_; ++i) {
        result[i] = x[fold(i)];
    }
    return result;
}

BandedMatrix BandedMatrix::inverse() const {
    BandedMatrix Z(n_, cyclic_);
    std::array<double, 8> below;  // the column of L below its diagonal
    for (std::size_t j = n_; j-- > 0;) {
        const std::size_t count = std::min(n_ - 1 - j, width_ - 1);
        for (std::size_t k = 0; k < count; ++k) {
            below[k] = at(j + 1 + k, j);
        }
        double diagonal = 1 / at(j, j);
        for (std::size_t i = 0; i < count; ++i) {
            const double* row = &Z.at(j + 1 + i, j + 1);
            double sum = 0;
            for (std::size_t k = 0; k <= i; ++k) {
                sum -= below[k] * row[k];
            }
            for (std::size_t k = i + 1; k < count; ++k) {
                sum -= below[k] * Z.at(j + 1 + k, j + 1 + i);
            }
            Z.at(j + 1 + i, j) = sum;
            diagonal -= below[i] * sum;
        }
        Z.at(j, j) = diagonal;
    }
    return Z;
}

}  // namespace seampath
