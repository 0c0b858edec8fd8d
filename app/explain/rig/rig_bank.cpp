// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "app/explain/rig/rig_search.hpp"

namespace dampline::app {
namespace {

constexpr int kPoints = 400;
constexpr double kFree = 0.1;  // of the level: as good as no force

/// What a bank says in lengths and forces: coming from full slip on one side and moving to full
/// slip on the other, slowly.
struct Read {
  double level_up_n{0.0};
  double level_down_n{0.0};
  double free_play_m{0.0};
  double stiffness_npm{0.0};
};

Read read_bank(const std::vector<RigColumn>& columns, const Eigen::VectorXd& theta,
               double longest_m) {
  RigSeries slow;
  slow.start_m = -longest_m;
  slow.deflection_m.setLinSpaced(kPoints + 1, 0.0, 2.0 * longest_m);
  slow.velocity_mps.setZero(kPoints + 1);
  slow.force_n.setZero(kPoints + 1);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(kPoints + 1);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].kind >= RigColumn::Kind::kStop)
      force += theta[static_cast<Eigen::Index>(i)] * evaluate(columns[i], slow);
  Read out;
  out.level_up_n = force[kPoints];
  out.level_down_n = force[0];
  const double step_m = 2.0 * longest_m / kPoints;
  const double free_n = kFree * 0.5 * (std::abs(out.level_up_n) + std::abs(out.level_down_n));
  for (Eigen::Index i = 0; i <= kPoints; ++i)
    if (std::abs(force[i]) < free_n) out.free_play_m += step_m;
  for (Eigen::Index i = 4; i <= kPoints; ++i)
    out.stiffness_npm = std::max(out.stiffness_npm, (force[i] - force[i - 4]) / (4.0 * step_m));
  return out;
}

}  // namespace

/// The deviation of each figure by the jackknife over the folds.
void RigSearch::describe_bank(Chosen& chosen, const Judged& now) const {
  std::vector<RigColumn> columns;
  for (const Eigen::Index i : set_of(chosen_columns(), now.width))
    columns.push_back(library_.columns[static_cast<std::size_t>(i)]);
  double longest_m = 0.0;
  for (const BankElement& e : bank_) longest_m = std::max(longest_m, e.travel_m);
  const Read all = read_bank(columns, now.fit.theta, longest_m);
  std::vector<Read> left;
  for (const Eigen::VectorXd& theta : now.fit.left_out)
    left.push_back(read_bank(columns, theta, longest_m));
  const auto add = [&](const std::string& name, double Read::*value, const char* unit) {
    double mean = 0.0;
    double squares = 0.0;
    const auto n = static_cast<double>(left.size());
    for (const Read& r : left) mean += r.*value / n;
    for (const Read& r : left) squares += (r.*value - mean) * (r.*value - mean);
    chosen.step.parameters.push_back({name, all.*value, std::sqrt((n - 1.0) / n * squares), unit});
  };
  const std::string& effect = chosen.step.effect;
  add(effect + "_force_positive", &Read::level_up_n, "N");
  add(effect + "_force_negative", &Read::level_down_n, "N");
  add(effect == "backlash" ? "backlash_gap" : effect + "_free_play", &Read::free_play_m, "m");
  add(effect + "_contact_stiffness", &Read::stiffness_npm, "N/m");
  int number = 0;
  for (const BankElement& e : bank_)
    chosen.step.parameters.push_back({effect + "_travel_" + std::to_string(++number),
                                      2.0 * e.travel_m, 0.07 * 2.0 * e.travel_m, "m"});
}

}  // namespace dampline::app
