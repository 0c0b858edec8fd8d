// SPDX-License-Identifier: MIT
#include "app/explain/rig/rig_search.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace dampline::app {
namespace {

constexpr double kClearGain = 0.05;   // passes on its own
constexpr double kSmallGain = 0.025;  // passes with kSignificant
constexpr double kSignificant = 2.0;
constexpr double kLaterGain = 0.15;  // what the first leaves has many likenesses
constexpr double kLaterSignificant = 3.0;
constexpr double kNeeded = 0.01;  // loss without it that keeps an effect
constexpr double kBankRidge = 1e-2;
constexpr double kBankFrom = 0.4;  // travels that are tried, of the smallest form's
constexpr double kBankTo = 2.1;
constexpr double kBankStep = 1.15;
constexpr std::size_t kBankSpread = 3;  // steps between the three travels of a bank
constexpr double kAlike = 0.01;         // of what either leaves
constexpr std::size_t kMostSteps = 4;
constexpr std::size_t kRunnersUp = 4;

bool has_memory(const std::string& effect) {
  return effect == "backlash" || effect == "presliding_hysteresis";
}

double block_t(const RigFit& before, const RigFit& after) {
  const auto n = static_cast<double>(before.block_error.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < before.block_error.size(); ++b) {
    const double d = before.block_error[b] - after.block_error[b];
    sum += d;
    squares += d * d;
  }
  const double variance = (squares - sum * sum / n) / (n - 1.0);
  return variance > 0.0 ? sum / std::sqrt(n * variance) : 0.0;
}

ColumnSet joined(ColumnSet a, const ColumnSet& b) {
  for (const Eigen::Index i : b)
    if (std::find(a.begin(), a.end(), i) == a.end()) a.push_back(i);
  return a;
}

/// The best candidate of an effect.
struct Best {
  const RigCandidate* candidate{nullptr};
  double gain{0.0};
  double t{0.0};
  double nmse{0.0};
};

/// Of candidates that explain alike, the one with the fewest coefficients comes first.
void prefer_plain(std::vector<Best>& order) {
  std::size_t pick = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool alike = order[i].nmse <= (1.0 + kAlike) * order[0].nmse;
    const bool plainer = order[i].candidate->columns.size() < order[pick].candidate->columns.size();
    if (alike && plainer) pick = i;
  }
  std::swap(order[0], order[pick]);
}

/// The hats of an element; the middle one of all but the first would be the first's again.
ColumnSet hats_of(const BankElement& element, bool first) {
  ColumnSet out = element.hats;
  if (!first) out.erase(out.begin() + RigColumn::kHats / 2);
  return out;
}

}  // namespace

RigSearch::RigSearch(const Config& config, const std::vector<RigSeries>& records)
    : records_{records}, scale_{scale_of(records)}, library_{make_library(config, scale_)} {
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
}

bool RigSearch::filtered() const {
  return std::any_of(library_.columns.begin(), library_.columns.end(),
                     [](const RigColumn& c) { return c.kind == RigColumn::Kind::kInertia; });
}

ColumnSet RigSearch::set_of(const ColumnSet& more, std::size_t width) const {
  ColumnSet out;
  if (library_.base_friction && base_friction_left_) out.push_back(library_.friction[width]);
  out = joined(out, library_.base);
  if (spring_added_) out = joined(out, {library_.spring});
  if (mass_added_) out = joined(out, {library_.mass});
  return joined(out, more);
}

double RigSearch::ridge() const {
  double out = 0.0;
  for (const Chosen& c : chosen_) out = std::max(out, c.ridge);
  return out;
}

RigSearch::Judged RigSearch::judge(const ColumnSet& more) const {
  Judged best;
  const bool profiled = library_.base_friction && base_friction_left_;
  for (std::size_t w = 0; w < (profiled ? library_.friction.size() : 1); ++w) {
    const RigFit fit = evidence_->fit(set_of(more, w), ridge());
    if (!fit.ok || (best.fit.ok && fit.held_out_nmse >= best.fit.held_out_nmse)) continue;
    best = {fit, w};
  }
  return best;
}

ColumnSet RigSearch::chosen_columns() const {
  ColumnSet out;
  for (const Chosen& c : chosen_) out = joined(out, c.candidate.columns);
  return out;
}

bool RigSearch::can_add(const RigCandidate& candidate) const {
  return std::none_of(chosen_.begin(), chosen_.end(), [&](const Chosen& c) {
    return c.candidate.effect == candidate.effect ||
           (has_memory(c.candidate.effect) && has_memory(candidate.effect));
  });
}

std::vector<std::string> RigSearch::terms() const {
  std::vector<std::string> out = library_.base_terms;
  if (spring_added_) out.emplace_back("linear spring");
  if (mass_added_) out.emplace_back("moving mass");
  for (const Chosen& c : chosen_) out.push_back(c.candidate.effect);
  return out;
}

bool RigSearch::forward() {
  const ColumnSet now = chosen_columns();
  const Judged before = judge(now);
  const Judged beside_spring = judge(joined(now, {library_.spring}));
  const Judged beside_both = judge(joined(now, {library_.spring, library_.offset}));
  std::map<std::string, Best> best;
  for (const RigCandidate& c : library_.candidates) {
    if (!can_add(c)) continue;
    const Judged& reference = c.effect == "offset_force" ? beside_spring : beside_both;
    const Judged with = judge(joined(joined(now, {library_.spring, library_.offset}), c.columns));
    if (!with.fit.ok || !reference.fit.ok) continue;
    const ColumnSet set =
        set_of(joined(joined(now, {library_.spring, library_.offset}), c.columns), with.width);
    const auto at = std::find(set.begin(), set.end(), c.columns.front()) - set.begin();
    if (c.sign * with.fit.theta[at] < 0.0) continue;
    const double gain = 1.0 - with.fit.held_out_nmse / reference.fit.held_out_nmse;
    Best& b = best[c.effect];
    if (b.candidate != nullptr && gain <= b.gain) continue;
    b = {&c, gain, block_t(reference.fit, with.fit), with.fit.held_out_nmse};
  }
  std::vector<Best> order;
  order.reserve(best.size());
  for (const auto& [effect, b] : best) order.push_back(b);
  std::sort(order.begin(), order.end(),
            [](const Best& a, const Best& b) { return a.gain > b.gain; });
  if (order.empty()) return false;
  prefer_plain(order);
  const Best& top = order.front();
  const bool passes = chosen_.empty()
                          ? top.gain > kClearGain || (top.gain > kSmallGain && top.t > kSignificant)
                          : top.gain > kLaterGain && top.t > kLaterSignificant;
  rejected_.clear();
  for (std::size_t i = 0; i < order.size() && i <= kRunnersUp; ++i)
    rejected_.push_back({order[i].candidate->effect, order[i].nmse, order[i].gain, order[i].t});
  if (!passes) return false;
  Chosen chosen{*top.candidate, {}, 0.0};
  chosen.step.effect = top.candidate->effect;
  chosen.step.held_out_before = before.fit.held_out_nmse;
  chosen.step.gain = top.gain;
  chosen.step.block_t = top.t;
  chosen.step.runners_up.assign(rejected_.begin() + 1, rejected_.end());
  rejected_.clear();
  chosen_.push_back(chosen);
  if (!filtered()) try_linear(mass_added_);
  if (has_memory(chosen.step.effect)) refine(chosen_.back());
  chosen_.back().step.held_out_after = judge(chosen_columns()).fit.held_out_nmse;
  chosen_.back().step.terms = terms();
  return true;
}

/// Three stop operators, their travels half as large again from one to the next, and what the
/// longest loses with speed on either side, now and soon after breakaway.
void RigSearch::refine(Chosen& memory) {
  std::vector<BankElement> elements;
  for (const double share : ratios(kBankFrom, kBankTo, kBankStep))
    elements.push_back(add_bank_element(library_, share * memory.candidate.place));
  evidence_ = std::make_unique<RigEvidence>(library_.columns, records_);
  const RigCandidate small = memory.candidate;
  double error = judge(chosen_columns()).fit.held_out_nmse;
  ColumnSet best = small.columns;
  memory.ridge = kBankRidge;
  for (std::size_t i = kBankSpread; i + kBankSpread < elements.size(); ++i) {
    const BankElement& shortest = elements[i - kBankSpread];
    const BankElement& longest = elements[i + kBankSpread];
    ColumnSet columns = joined(hats_of(elements[i], true), hats_of(shortest, false));
    columns = joined(joined(columns, hats_of(longest, false)), longest.speed);
    memory.candidate.columns = columns;
    const RigFit fit = judge(chosen_columns()).fit;
    if (!fit.ok || fit.held_out_nmse >= error) continue;
    error = fit.held_out_nmse;
    best = columns;
    bank_ = {shortest, elements[i], longest};
  }
  memory.candidate.columns = best;
  if (bank_.empty()) {
    memory.ridge = 0.0;
    return;
  }
  base_friction_left_ = false;
  base_friction_left_ = judge(chosen_columns()).fit.held_out_nmse > error;
}

/// A linear term that belongs to the rig rather than to the damper stays where it helps.
void RigSearch::try_linear(bool& added) {
  if (added) return;
  const double without = judge(chosen_columns()).fit.held_out_nmse;
  added = true;
  added = judge(chosen_columns()).fit.held_out_nmse < (1.0 - kNeeded) * without;
}

void RigSearch::backward() {
  for (std::size_t i = 0; chosen_.size() > 1 && i < chosen_.size();) {
    const double with = judge(chosen_columns()).fit.held_out_nmse;
    const Chosen removed = chosen_[i];
    if (has_memory(removed.candidate.effect)) {
      ++i;
      continue;
    }
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(i));
    const Judged without = judge(chosen_columns());
    if (without.fit.ok && without.fit.held_out_nmse < (1.0 + kNeeded) * with) {
      i = 0;
      continue;
    }
    chosen_.insert(chosen_.begin() + static_cast<std::ptrdiff_t>(i), removed);
    ++i;
  }
}

RigExplanation RigSearch::run() {
  RigExplanation out;
  for (const RigSeries& s : records_) out.records.push_back(s.record);
  out.whole_records = evidence_->folds() == records_.size();
  if (filtered()) out.filter_hz = records_.front().config.corner_hz;
  describe(out.base, judge({}), {});
  while (chosen_.size() < kMostSteps && forward()) {
  }
  backward();
  if (!library_.base_spring) try_linear(spring_added_);
  const Judged now = judge(chosen_columns());
  describe_steps(now);
  out.rejected = rejected_;
  describe(out.final, now, chosen_columns());
  for (const Chosen& c : chosen_) {
    out.steps.push_back(c.step);
    for (const Parameter& p : c.step.parameters) out.final.parameters.push_back(p);
  }
  return out;
}

}  // namespace dampline::app
