// SPDX-License-Identifier: MIT
#include "app/wavelet/deflections.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "app/error.hpp"
#include "published/oscillator/drift_free_window.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr std::size_t kReach = FlatIntegral::kReach;

/// Legendre polynomials of degree 0 to kSlow - 1 over `rows` points.
Eigen::MatrixXd slow_columns(Eigen::Index rows) {
  Eigen::MatrixXd out{rows, kSlow};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double u = (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(rows) - 1.0;
    out(i, 0) = 1.0;
    out(i, 1) = u;
    for (int j = 2; j < kSlow; ++j)
      out(i, j) = ((2.0 * j - 1.0) * u * out(i, j - 1) - (j - 1.0) * out(i, j - 2)) / j;
  }
  return out;
}

/// Running integral; five samples at each end of `in` are not in it.
Eigen::VectorXd integrated(const Eigen::VectorXd& in, double step_s) {
  const auto at = [&](long j) { return in[j]; };
  const auto reach = static_cast<Eigen::Index>(kReach);
  Eigen::VectorXd out{in.size() - 2 * reach};
  double sum = 0.0;
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out[i] = sum += step_s * FlatIntegral::over_step(i + reach, at);
  return out;
}

/// Makes the windows of one record.
class Windows {
 public:
  Windows(const Measured& in, double block_s)
      : in_{in},
        block_{static_cast<std::size_t>(std::lround(block_s / in.step_s))},
        guard_{block_ / 2},
        slow_{slow_columns(static_cast<Eigen::Index>(block_ + 2 * guard_)).householderQr()} {}

  Measured make() {
    Measured out = in_;
    out.from_accelerations = true;
    out.time_s.clear();
    out.stretches.clear();
    for (std::size_t m = 0; m < 2; ++m) {
      out.deflection_m[m].clear();
      out.force_n[m].clear();
    }
    for (const Stretch& s : in_.stretches)
      for (std::size_t first = s.begin; first + needed() <= s.end; first += block_) add(first, out);
    if (out.stretches.empty())
      throw RunError{
          fmt::format("{}: found no stretch of {:.3g} s without a gap, expected one for a window; "
                      "--block makes "
                      "it shorter",
                      in_.name, static_cast<double>(needed()) * in_.step_s)};
    return out;
  }

 private:
  [[nodiscard]] std::size_t length() const { return block_ + 2 * guard_; }
  [[nodiscard]] std::size_t needed() const { return length() + 4 * kReach; }

  [[nodiscard]] Eigen::VectorXd without_drift(const Eigen::VectorXd& in) const {
    const Eigen::VectorXd turned = slow_.householderQ().transpose() * in;
    Eigen::VectorXd rest = turned;
    rest.head(kSlow).setZero();
    return slow_.householderQ() * rest;
  }

  /// Against the base, of the window that begins 2 kReach behind `first`.
  [[nodiscard]] Eigen::VectorXd deflection(std::size_t mass, std::size_t first) const {
    Eigen::VectorXd relative{static_cast<Eigen::Index>(needed())};
    for (std::size_t i = 0; i < needed(); ++i)
      relative[static_cast<Eigen::Index>(i)] =
          in_.deflection_m[mass][first + i] - in_.force_n[mass][first + i];
    relative.array() -= relative.mean();
    Eigen::VectorXd velocity = integrated(relative, in_.step_s);
    velocity.array() -= velocity.mean();
    return without_drift(integrated(velocity, in_.step_s));
  }

  void add(std::size_t first, Measured& out) const {
    const std::size_t begin = out.time_s.size();
    const std::size_t from = first + 2 * kReach;
    for (std::size_t i = 0; i < length(); ++i) out.time_s.push_back(in_.time_s[from + i]);
    for (std::size_t m = 0; m < static_cast<std::size_t>(in_.masses); ++m) {
      const Eigen::VectorXd x = deflection(m, first);
      out.deflection_m[m].insert(out.deflection_m[m].end(), x.begin(), x.end());
      for (std::size_t i = 0; i < length(); ++i)
        out.force_n[m].push_back(-in_.force_n[m][from + i]);
    }
    out.stretches.push_back({begin, begin + length()});
    out.blocks.push_back({begin + guard_, begin + guard_ + block_});
  }

  const Measured& in_;
  std::size_t block_;
  std::size_t guard_;
  Eigen::HouseholderQR<Eigen::MatrixXd> slow_;
};

}  // namespace

Measured deflections_from_accelerations(const Measured& accelerations, double block_s) {
  constexpr double kFewestPerBlock = 100.0;
  if (block_s < kFewestPerBlock * accelerations.step_s)
    throw UsageError{fmt::format("--block: found {:g} s, expected at least {:.3g} s at this rate",
                                 block_s, kFewestPerBlock * accelerations.step_s)};
  return Windows{accelerations, block_s}.make();
}

}  // namespace dampline::app::wavelet
