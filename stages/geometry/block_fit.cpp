#include "stages/geometry/block_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/f_test.hpp"

namespace seampath {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Normal equations of one block, and how its own parameters follow the shared ones.
struct Normal {
    MatrixXd ss, so, oo;
    VectorXd s, o;
    double chi2 = 0;
    Index count = 0;
};

double square_sum(const BlockProblem& problem, const VectorXd& shared, const std::vector<VectorXd>& own) {
    double sum = 0;
    for (std::size_t i = 0; i < problem.blocks; ++i) {
        sum += problem.residuals(i, shared, own[i]).squaredNorm();
    }
    return sum;
}

MatrixXd differences(const VectorXd& at, const VectorXd& unit, Index rows,
                     const std::function<VectorXd(const VectorXd&)>& residuals) {
    MatrixXd J(rows, at.size());
    for (Index k = 0; k < at.size(); ++k) {
        VectorXd low = at, high = at;
        low[k] -= unit[k];
        high[k] += unit[k];
        J.col(k) = (residuals(high) - residuals(low)) / (high[k] - low[k]);
    }
    return J;
}

Normal normal_of(const BlockProblem& problem, std::size_t block, const VectorXd& shared, const VectorXd& own) {
    const VectorXd r = problem.residuals(block, shared, own);
    const MatrixXd S = differences(shared, problem.shared_unit, r.size(),
                                   [&](const VectorXd& x) { return problem.residuals(block, x, own); });
    const MatrixXd O = differences(own, problem.own_unit, r.size(),
                                   [&](const VectorXd& x) { return problem.residuals(block, shared, x); });
    return {S.transpose() * S, S.transpose() * O, O.transpose() * O, S.transpose() * r,
            O.transpose() * r, r.squaredNorm(),   r.size()};
}

MatrixXd damped(MatrixXd H, double damping) {
    H.diagonal() *= 1 + damping;
    return H;
}

// The block's own parameters eliminated.
BlockShare share_of(const Normal& n, double damping) {
    BlockShare share{damped(n.ss, damping), n.s, n.chi2, n.count - n.o.size()};
    if (n.o.size() > 0) {
        const Eigen::LDLT<MatrixXd> own(damped(n.oo, damping));
        share.H -= n.so * own.solve(n.so.transpose());
        share.g -= n.so * own.solve(n.o);
    }
    return share;
}

struct Step {
    VectorXd shared;
    std::vector<VectorXd> own;
};

Step step_of(const std::vector<Normal>& normals, const VectorXd& shared, const std::vector<VectorXd>& own,
             double damping) {
    MatrixXd H = MatrixXd::Zero(shared.size(), shared.size());
    VectorXd g = VectorXd::Zero(shared.size());
    for (const Normal& n : normals) {
        const BlockShare share = share_of(n, damping);
        H += share.H;
        g += share.g;
    }
    const VectorXd step = -Eigen::LDLT<MatrixXd>(H).solve(g);
    Step next{shared + step, own};
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Normal& n = normals[i];
        if (n.o.size() > 0) {
            next.own[i] -= Eigen::LDLT<MatrixXd>(damped(n.oo, damping)).solve(n.o + n.so.transpose() * step);
        }
    }
    return next;
}

std::vector<Normal> normals_of(const BlockProblem& problem, const VectorXd& shared, const std::vector<VectorXd>& own) {
    std::vector<Normal> normals;
    for (std::size_t i = 0; i < problem.blocks; ++i) {
        normals.push_back(normal_of(problem, i, shared, own[i]));
    }
    return normals;
}

void finish(const std::vector<Normal>& normals, BlockFit& fit) {
    fit.information = MatrixXd::Zero(fit.shared.size(), fit.shared.size());
    fit.chi2 = 0;
    fit.redundancy = -fit.shared.size();
    for (const Normal& n : normals) {
        fit.blocks.push_back(share_of(n, 0));
        fit.information += fit.blocks.back().H;
        fit.chi2 += n.chi2;
        fit.redundancy += fit.blocks.back().count;
    }
}

}  // namespace

MatrixXd BlockFit::covariance() const {
    // About a unit diagonal: parameters are px, mm and rad.
    const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd unit = scale.asDiagonal() * information * scale.asDiagonal();
    const MatrixXd inverse = Eigen::LDLT<MatrixXd>(unit).solve(MatrixXd::Identity(unit.rows(), unit.cols()));
    return scale.asDiagonal() * inverse * scale.asDiagonal();
}

double BlockFit::variance_factor() const {
    return redundancy > 0 ? chi2 / static_cast<double>(redundancy) : 1;
}

BlockFit fit_blocks(const BlockProblem& problem, VectorXd shared, std::vector<VectorXd> own) {
    constexpr int kMostRounds = 200;
    constexpr double kExact = 1e-10;       // relative change of chi-squared
    constexpr double kNoResidual = 1e-20;  // of a sigma, squared: what is measured without error fits exactly
    constexpr double kMostDamping = 1e12;
    ensure(own.size() == problem.blocks, "each block has its own parameters");
    BlockFit fit{std::move(shared), std::move(own), {}, {}, 0, 0, false};
    double chi2 = square_sum(problem, fit.shared, fit.own), damping = 1e-6;
    std::vector<Normal> normals = normals_of(problem, fit.shared, fit.own);
    for (int round = 0; round < kMostRounds && damping < kMostDamping && !fit.converged; ++round) {
        Step next = step_of(normals, fit.shared, fit.own, damping);
        const double then = square_sum(problem, next.shared, next.own);
        if (!(then < chi2)) {  // NaN, too
            fit.converged = std::abs(then - chi2) <= kExact * chi2 + kNoResidual;
            damping *= 10;
            continue;
        }
        fit.converged = damping < 1 && chi2 - then <= kExact * chi2 + kNoResidual;  // damped steps are small anyway
        chi2 = then;
        fit.shared = std::move(next.shared);
        fit.own = std::move(next.own);
        normals = normals_of(problem, fit.shared, fit.own);
        damping = std::max(1e-12, damping / 10);
    }
    finish(normals, fit);
    return fit;
}

WithoutBlock without_block(const BlockFit& fit, std::size_t block) {
    const BlockShare& own = fit.blocks.at(block);
    VectorXd g = VectorXd::Zero(fit.shared.size());
    double chi2 = 0;
    for (std::size_t i = 0; i < fit.blocks.size(); ++i) {
        if (i != block) {
            g += fit.blocks[i].g;
            chi2 += fit.blocks[i].chi2;
        }
    }
    WithoutBlock result;
    result.step = -Eigen::LDLT<MatrixXd>(fit.information - own.H).solve(g);
    result.chi2 = std::max(0.0, chi2 + g.dot(result.step));
    const auto count = static_cast<double>(own.count), left = static_cast<double>(fit.redundancy - own.count);
    if (left > 0 && result.chi2 > 0) {
        result.p_value = f_tail((fit.chi2 - result.chi2) / count / (result.chi2 / left), count, left);
    }
    return result;
}

}  // namespace seampath
