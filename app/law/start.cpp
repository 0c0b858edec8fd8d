// SPDX-License-Identifier: MIT
#include "app/law/start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "app/law/shooting.hpp"

namespace dampline::app::law {
namespace {

constexpr double kStartPeriods = 16.0;  // that tell a record's start
constexpr double kSameStart = 4.0;  // times the deflection's noise: the first sample bears it out

}  // namespace

double period_of(const Eigen::VectorXd& deflection_m, const Eigen::VectorXd& velocity_mps) {
  const Eigen::ArrayXd x = deflection_m.array() - deflection_m.mean();
  return 2.0 * std::numbers::pi * std::sqrt(x.square().sum() / velocity_mps.squaredNorm());
}

State start_of(const Law& law, const Measured& motion) {
  const State seen{motion.deflection_m[0], motion.velocity_mps[0]};
  const double span_s = kStartPeriods * period_of(motion.deflection_m, motion.velocity_mps);
  if (!std::isfinite(span_s)) return seen;
  const auto all = static_cast<double>(motion.force_n.size());
  const auto count = static_cast<Eigen::Index>(std::clamp(span_s / motion.interval_s, 2.0, all));
  const std::vector<Drive> drives{{Input{motion.force_n.head(count), motion.interval_s},
                                   motion.deflection_m.head(count),
                                   motion.velocity_mps.head(count),
                                   {}}};
  const Shot shot = follow([&law](const Eigen::VectorXd&) { return law; }, {}, drives,
                           static_cast<double>(count) * motion.interval_s);
  if (!shot.ok) return seen;
  State out = shot.start;
  if (std::abs(out.deflection_m - seen.deflection_m) > kSameStart * motion.noise_m) {
    out.deflection_m = seen.deflection_m;
    out.velocity_mps = seen.velocity_mps;
  }
  return out;
}

}  // namespace dampline::app::law
