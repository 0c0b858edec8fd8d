// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/bank.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app::rig {
namespace {

constexpr int kPoints = 400;
constexpr double kFree = 0.1;   // of the level: as good as no force
constexpr double kSoft = 0.25;  // of the level

}  // namespace

double longest_of(const std::vector<BankElement>& bank) {
  double out = 0.0;
  for (const BankElement& e : bank) out = std::max(out, e.travel_m);
  return out;
}

BankFigures read_bank(const std::vector<Regressor>& columns, const Eigen::VectorXd& theta,
                      double longest_m) {
  Series slow;
  slow.start_m = -longest_m;
  slow.deflection_m.setLinSpaced(kPoints + 1, 0.0, 2.0 * longest_m);
  slow.velocity_mps.setConstant(kPoints + 1, 1e-9);
  slow.force_n.setZero(kPoints + 1);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(kPoints + 1);
  double sign_n = 0.0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].kind >= Kind::kStop)
      force += theta[static_cast<Eigen::Index>(i)] * evaluate(columns[i], slow);
    else if (columns[i].kind == Kind::kSign)
      sign_n += theta[static_cast<Eigen::Index>(i)];
  force.tail(kPoints).array() += sign_n;
  force[0] -= sign_n;
  BankFigures out;
  out.level_up_n = force[kPoints];
  out.level_down_n = force[0];
  const double step_m = 2.0 * longest_m / kPoints;
  out.step_m = step_m;
  const double free_n = kFree * 0.5 * (std::abs(out.level_up_n) + std::abs(out.level_down_n));
  double between_m = 0.0;
  double soft_m = 0.0;
  for (Eigen::Index i = 0; i <= kPoints; ++i) {
    if (std::abs(force[i]) < free_n) out.free_play_m += step_m;
    if (force[i] > (1.0 - kFree) * out.level_down_n && force[i] < (1.0 - kFree) * out.level_up_n)
      between_m += step_m;
    if (std::abs(force[i]) < kSoft / kFree * free_n) soft_m += step_m;
  }
  out.play_share = between_m > 0.0 ? soft_m / between_m : 0.0;
  for (Eigen::Index i = 5; i <= kPoints; ++i)  // the first step is that of the sign
    out.stiffness_npm = std::max(out.stiffness_npm, (force[i] - force[i - 4]) / (4.0 * step_m));
  return out;
}

}  // namespace dampline::app::rig
