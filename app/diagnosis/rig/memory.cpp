// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/search.hpp"

namespace dampline::app::rig {
namespace {

constexpr int kPoints = 400;
constexpr double kFree = 0.1;  // of the level: as good as no force
constexpr double kBankRidge = 1e-2;
constexpr double kBankFrom = 0.4;  // travels that are tried, of the smallest form's
constexpr double kBankTo = 2.1;
constexpr double kBankStep = 1.15;
constexpr std::size_t kBankSpread = 3;  // steps between the three travels of a bank
constexpr double kSoft = 0.25;          // of the level
constexpr double kPlay =
    0.45;  // share of the build-up below that: free play; a straight one has 0.28
constexpr double kSmoother = 0.8;  // of what the bank leaves
constexpr double kFrictionStays = 0.97;
constexpr double kUndecided = 1.6;  // between the errors of the smallest forms

/// What a bank says in lengths and forces: coming from full slip on one side and moving to full
/// slip on the other, slowly.
struct Read {
  double level_up_n{0.0};
  double level_down_n{0.0};
  double free_play_m{0.0};
  double stiffness_npm{0.0};
  double play_share{0.0};  ///< travel below kSoft over that between nine tenths of either level
};

double longest_of(const std::vector<BankElement>& bank) {
  double out = 0.0;
  for (const BankElement& e : bank) out = std::max(out, e.travel_m);
  return out;
}

Read read_bank(const std::vector<Regressor>& columns, const Eigen::VectorXd& theta,
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
  Read out;
  out.level_up_n = force[kPoints];
  out.level_down_n = force[0];
  const double step_m = 2.0 * longest_m / kPoints;
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
  for (Eigen::Index i = 4; i <= kPoints; ++i)
    out.stiffness_npm = std::max(out.stiffness_npm, (force[i] - force[i - 4]) / (4.0 * step_m));
  return out;
}

/// The hats of an element; the middle one of all but the first would be the first's again.
ColumnSet hats_of(const BankElement& element, bool first) {
  ColumnSet out = element.hats;
  if (!first) out.erase(out.begin() + Regressor::kHats / 2);
  return out;
}

}  // namespace

/// Three stop operators, their travels half as large again from one to the next, and what the
/// longest loses with speed on either side, now and soon after breakaway.
void Search::refine(Chosen& memory) {
  std::vector<BankElement> elements;
  for (const double share : ratios(kBankFrom, kBankTo, kBankStep))
    elements.push_back(add_bank_element(library_, share * memory.candidate.place));
  evaluate_columns();
  const Candidate small = memory.candidate;
  double least = error();
  ColumnSet best = small.columns;
  memory.ridge = kBankRidge;
  for (std::size_t i = kBankSpread; i + kBankSpread < elements.size(); ++i) {
    const BankElement& shortest = elements[i - kBankSpread];
    const BankElement& longest = elements[i + kBankSpread];
    ColumnSet columns = joined(hats_of(elements[i], true), hats_of(shortest, false));
    columns = joined(joined(columns, hats_of(longest, false)), longest.speed);
    memory.candidate.columns = columns;
    const Fit fit = judge_chosen().fit;
    if (!fit.ok || fit.held_out_nmse >= least) continue;
    least = fit.held_out_nmse;
    best = columns;
    bank_ = {shortest, elements[i], longest};
  }
  memory.candidate.columns = best;
  if (bank_.empty()) {
    memory.ridge = 0.0;
    return;
  }
  base_friction_left_ = false;
  base_friction_left_ = error() > least;
  rename_memory(memory);
}

/// Where the smallest forms are close, the bank's shape decides: free play is a build-up that
/// pauses at no force.
void Search::rename_memory(Chosen& memory) const {
  if (memory.other_memory == 0.0 || memory.other_memory > kUndecided) return;
  const Judged now = judge_chosen();
  const Read read = read_bank(columns_of(now.set), now.fit.theta, longest_of(bank_));
  if (read.play_share > kPlay) memory.step.effect = memory.candidate.effect = "backlash";
}

/// One smooth law with two figures instead of a bank, where it leaves clearly less.
void Search::try_bouc_wen(Chosen& memory) {
  const Chosen before = memory;
  const bool friction = base_friction_left_;
  const double by_bank = error();
  memory.candidate.columns.clear();
  memory.ridge = 0.0;
  base_friction_left_ = true;
  bouc_wen_ = best_bouc_wen(records_, trial_base(), scale_.deflection_m);
  if (bouc_wen_) {
    memory.candidate.columns = {library_.add(bouc_wen_->column)};
    evaluate_columns();
    const double with = error();
    base_friction_left_ = false;
    const double alone = error();
    base_friction_left_ = with < kFrictionStays * alone;
    if (std::min(with, alone) < kSmoother * by_bank) {
      memory.step.effect = memory.candidate.effect = "presliding_hysteresis";
      bank_.clear();
      return;
    }
  }
  bouc_wen_.reset();
  memory = before;
  base_friction_left_ = friction;
}

void Search::describe_bouc_wen(Chosen& chosen, const Estimate& first) const {
  const Regressor& law = bouc_wen_->column;
  const double travel_std_m = bouc_wen_->travel_std_m;
  const double shape_std = bouc_wen_->shape_std;
  auto& out = chosen.step.parameters;
  const double slips = 1.0 + law.b;
  const double slip_m = bouc_wen_slip_m(law.a, law.b);
  if (slips > 2.0 * shape_std && slip_m > 0.0) {
    const double force_n = first.value * slip_m;
    const double share =
        std::hypot(first.std / first.value, travel_std_m / law.a, shape_std / slips);
    out.push_back({"presliding_hysteresis_force", force_n, share * force_n, "N"});
  }
  out.push_back({"presliding_hysteresis_stiffness", first.value, first.std, "N/m"});
  out.push_back({"presliding_hysteresis_travel", law.a, travel_std_m, "m"});
  out.push_back({"presliding_hysteresis_shape", law.b, shape_std, ""});
}

/// The deviation of each figure by the jackknife over the folds.
void Search::describe_bank(Chosen& chosen, const Judged& now) const {
  const std::vector<Regressor> columns = columns_of(now.set);
  const double longest_m = longest_of(bank_);
  const Read all = read_bank(columns, now.fit.theta, longest_m);
  std::vector<Read> left;
  for (const Eigen::VectorXd& theta : now.fit.left_out)
    left.push_back(read_bank(columns, theta, longest_m));
  const auto add = [&](const std::string& name, double Read::*value, const char* unit) {
    std::vector<double> values;
    values.reserve(left.size());
    for (const Read& r : left) values.push_back(r.*value);
    chosen.step.parameters.push_back({name, all.*value, jackknife_std(values), unit});
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

}  // namespace dampline::app::rig
