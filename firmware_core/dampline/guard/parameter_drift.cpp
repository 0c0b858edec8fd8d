// SPDX-License-Identifier: MIT
#include "dampline/guard/parameter_drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dampline/estimate/law_profile.hpp"
#include "dampline/guard/block_series.hpp"
#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr std::size_t kFewest = 10;  // entries
constexpr std::size_t kFolds = 5;
constexpr std::size_t kSide = 2;  // entries before and after a step
// A change is named when it explains so much of the held-out error, or less where the entries' own
// values step. Of 192 sound records none stepped by more than 4.6 deviations.
constexpr double kGain = 0.025;
constexpr double kLeastT = 4.0;
constexpr double kLeastGain = 0.0015;
constexpr double kLeastChange = 0.03;
constexpr double kStepSignificant = 6.0;
// Where the frame moves less it sticks more, and friction seems to be more: in simulated records
// with a change of speed by 1.5 to 5.2 % for each factor e of the deflection.
constexpr double kChangeOfMotion = 0.06;
constexpr double kLeastEntryS = 3.0;  // one block alone has no friction and spring of its own
// A mass moves the frame by a quarter as much at 1.2 Hz, and the other way round.
constexpr double kGainNotMass = 0.4;
constexpr double kGainExcluded = 2.0;  // deviations: no load changes on the way
// Of the live alarm.
constexpr double kMostOfThreshold = 1.0 / 3.0;  // that one group adds: no alarm from one or two
constexpr double kLeastShare = 0.5;             // of the other's change: both are the mass

using Model = LawModel<false>;
using Profile = LawProfile<false>;
constexpr int kUnknowns = Model::kUnknowns;
using Theta = Eigen::Matrix<double, kUnknowns, 1>;
using Gram = Eigen::Matrix<double, kUnknowns + 1, kUnknowns + 1>;
constexpr int kMore = kUnknowns + 1;  // unknowns with the change
using MoreTheta = Eigen::Matrix<double, kMore, 1>;
using MoreGram = Eigen::Matrix<double, kMore + 1, kMore + 1>;
using Square = Eigen::Matrix<double, kMore, kMore>;
using Weights = std::array<double, kEntries>;

struct Entries {
  std::array<Gram, kEntries> gram{};
  std::size_t count{0};
};

Gram gram_of(const ScaleFactors& factors, const Profile& law) noexcept {
  return weighted_gram<kUnknowns>(law.fit, factors, MappedColumns<kUnknowns>{law.map});
}

/// Friction and spring that sums ask for where the law's width is held; false: they do not tell.
bool level_of(const Gram& g, double width_change, GroupMeter::Group& out) noexcept {
  constexpr int kF = Model::kCoulomb;
  constexpr int kK = Model::kStiffness;
  const auto target = [&](int i) {
    return g(i, kUnknowns) - width_change * g(i, Model::kWidthChange);
  };
  const double determinant = g(kF, kF) * g(kK, kK) - g(kF, kK) * g(kF, kK);
  if (!(determinant > 0.0)) return false;
  out.friction_mps2 = (g(kK, kK) * target(kF) - g(kF, kK) * target(kK)) / determinant;
  out.stiffness_ps2 = (g(kF, kF) * target(kK) - g(kF, kK) * target(kF)) / determinant;
  return true;
}

/// The entry's gram with the column w X u.
MoreGram extended(const Gram& gram, double weight, const Theta& u) noexcept {
  Eigen::Matrix<double, kUnknowns + 1, kMore + 1> map;
  map.setZero();
  for (int i = 0; i < kUnknowns; ++i) {
    map(i, i) = 1.0;
    map(i, kUnknowns) = weight * u[i];
  }
  map(kUnknowns, kMore) = 1.0;
  const Eigen::Matrix<double, kUnknowns + 1, kMore + 1> half = gram.lazyProduct(map);
  return map.transpose().lazyProduct(half);
}

Theta scaled_part(DriftingParameter parameter, const Theta& theta) noexcept {
  Theta u = theta;
  if (parameter == DriftingParameter::kFriction) u[Model::kStiffness] = 0.0;
  if (parameter == DriftingParameter::kStiffness) {
    u[Model::kCoulomb] = 0.0;
    u[Model::kWidthChange] = 0.0;
  }
  return u;
}

Weights step_at(std::size_t entry) noexcept {
  Weights w{};
  for (std::size_t i = entry; i < kEntries; ++i) w[i] = 1.0;
  return w;
}

Weights trend_over(std::size_t count) noexcept {
  Weights w{};
  for (std::size_t i = 0; i < count; ++i) {
    w[i] = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  }
  return w;
}

/// Relative change of the parameter, with its deviation from the scores of the entries.
Estimate change_of(const Entries& entries, const Weights& weights, const Theta& u,
                   DriftingParameter parameter) noexcept {
  MoreGram all = MoreGram::Zero();
  for (std::size_t b = 0; b < entries.count; ++b) {
    all += extended(entries.gram[b], weights[b], u);
  }
  const MoreTheta theta = solve<kMore>(all);
  // Column of the inverse that belongs to the change.
  const MoreTheta inverse = solve_cholesky<kMore>(Square{all.topLeftCorner<kMore, kMore>()},
                                                  MoreTheta{MoreTheta::Unit(kUnknowns)});
  ScoreScatter<1> scatter;
  for (std::size_t b = 0; b < entries.count; ++b) {
    const MoreGram g = extended(entries.gram[b], weights[b], u);
    MoreTheta score = g.topRightCorner<kMore, 1>();
    score -= g.topLeftCorner<kMore, kMore>().lazyProduct(theta);
    scatter.add(ScoreScatter<1>::Vector{inverse.dot(score)});
  }
  const double variance = scatter.covariance(ScoreScatter<1>::Square::Identity())(0, 0);
  const double std =
      std::sqrt(std::max(variance, 0.0)) * short_record_factor(static_cast<double>(entries.count));
  const int which = parameter == DriftingParameter::kStiffness ? static_cast<int>(Model::kStiffness)
                                                               : static_cast<int>(Model::kCoulomb);
  const double c = theta[kUnknowns] * u[which] / theta[which];
  const double c_std = std::abs(std * u[which] / theta[which]);
  if (parameter != DriftingParameter::kMass) return {c, c_std};
  return {-c / (1.0 + c), c_std / ((1.0 + c) * (1.0 + c))};  // the rows are per unit of mass
}

/// Largest step of each entry's own friction and stiffness, with the law's width held.
void measure_steps(const Entries& entries, const Theta& theta, ParameterDrift& out) noexcept {
  BlockSeries friction;
  BlockSeries stiffness;
  for (std::size_t b = 0; b < entries.count; ++b) {
    GroupMeter::Group level;
    if (!level_of(entries.gram[b], theta[Model::kWidthChange], level)) continue;
    const auto tick = static_cast<std::int64_t>(b);
    friction.add(level.friction_mps2, tick);
    stiffness.add(level.stiffness_ps2, tick);
  }
  out.friction_significance = friction.step().significance;
  out.stiffness_significance = stiffness.step().significance;
}

/// By how much the deflection differs between the entries with a small weight and those with a
/// large one: |logarithm of the ratio of their rms|.
double change_of_motion(const Entries& entries, const Weights& weights) noexcept {
  std::array<double, 2> sum{};
  std::array<double, 2> count{};
  for (std::size_t b = 0; b < entries.count; ++b) {
    const std::size_t side = weights[b] > 0.5 ? 1 : 0;
    sum[side] += entries.gram[b](Model::kStiffness, Model::kStiffness);
    count[side] += 1.0;
  }
  if (!(sum[0] * sum[1] > 0.0)) return 0.0;
  return std::abs(0.5 * std::log(sum[1] * count[0] / (sum[0] * count[1])));
}

}  // namespace

ParameterDrift find_parameter_drift(const ScaleFactors& total, EntryList list,
                                    double entry_s) noexcept {
  ParameterDrift out;
  const Profile law = Profile::make(total, kAllScales);
  if (!law.fit.ok || list.size() < kFewest) return out;
  Entries entries;
  for (const ScaleFactors* factors : list) entries.gram[entries.count++] = gram_of(*factors, law);
  const auto plain = [&](std::size_t b) { return entries.gram[b]; };
  const double base = held_out<kUnknowns, kFolds>(entries.count, plain).error;
  if (!(base > 0.0)) return out;
  out.judged = true;
  double least = base;
  Weights best{};
  const auto consider = [&](DriftingParameter parameter, const Weights& weights, bool step,
                            std::size_t entry) {
    const Theta u = scaled_part(parameter, law.fit.theta);
    const auto more = [&](std::size_t b) { return extended(entries.gram[b], weights[b], u); };
    const double error = held_out<kMore, kFolds>(entries.count, more).error;
    if (!(error < least)) return;
    least = error;
    best = weights;
    out.parameter = parameter;
    out.step = step;
    out.time_s = step ? static_cast<double>(entry) * entry_s : 0.0;
  };
  for (const DriftingParameter parameter :
       {DriftingParameter::kFriction, DriftingParameter::kStiffness, DriftingParameter::kMass}) {
    for (std::size_t b = kSide; b + kSide <= entries.count; ++b) {
      consider(parameter, step_at(b), true, b);
    }
    consider(parameter, trend_over(entries.count), false, 0);
  }
  out.gain = 1.0 - least / base;
  out.interval_s = entry_s;
  if (out.gain <= 0.0) return out;
  out.change = change_of(entries, best, scaled_part(out.parameter, law.fit.theta), out.parameter);
  measure_steps(entries, law.fit.theta, out);
  const double t = std::abs(out.change.value) / std::max(out.change.std, 1e-300);
  const bool steps =
      entry_s > kLeastEntryS &&
      std::max(out.friction_significance, out.stiffness_significance) > kStepSignificant;
  const double motion = change_of_motion(entries, best);
  const bool large = std::abs(out.change.value) > kLeastChange + kChangeOfMotion * motion;
  out.found = t > kLeastT && large && (out.gain > kGain || (out.gain > kLeastGain && steps));
  return out;
}

ParameterDrift find_parameter_drift(const Statistics& statistics, double block_s) noexcept {
  std::array<const ScaleFactors*, kEntries> list{};
  const std::size_t count = std::min<std::size_t>(statistics.header.entry_count, kEntries);
  for (std::size_t i = 0; i < count; ++i) list[i] = &statistics.entries[i];
  return find_parameter_drift(statistics.total, EntryList{list.data(), count},
                              block_s * statistics.header.blocks_per_entry);
}

namespace {

bool moves_parameters(const Fault& fault) noexcept {
  switch (fault.kind) {
    case FaultKind::kLostSamples:
    case FaultKind::kRepeatedSamples:
      return fault.channel != FaultChannel::kAll;
    case FaultKind::kTimingStep:
    case FaultKind::kClockDrift:
    case FaultKind::kGainChange:
    case FaultKind::kSwappedChannels:
    case FaultKind::kWrongPolarity:
    case FaultKind::kIdenticalChannels:
      return true;
    default:
      return false;
  }
}

}  // namespace

void hold_against_faults(FaultView& faults, ParameterDrift& drift) noexcept {
  if (!drift.found) return;
  const FrameFollow& follow = faults.frame_follow;
  const double more = drift.step ? follow.step : follow.trend;
  const double sure = drift.step ? follow.step_significance : follow.trend_significance;
  const double gain = -drift.change.value;
  const double std = sure != 0.0 ? std::abs(more / sure) : 0.0;
  const bool is_gain =
      drift.parameter == DriftingParameter::kMass && std > 0.0 &&
      (more * gain > kGainNotMass * gain * gain || std::abs(more - gain) < kGainExcluded * std);
  if (is_gain && faults.count < faults.faults.size())
    faults.faults[faults.count++] = {.kind = FaultKind::kGainChange,
                                     .channel = FaultChannel::kFrame,
                                     .time_s = drift.time_s,
                                     .size = 100.0 * gain,
                                     .unit = unit_of(FaultKind::kGainChange),
                                     .count = 1,
                                     .last_s = drift.time_s};
  const auto list = faults.list();
  if (std::any_of(list.begin(), list.end(), moves_parameters)) drift.found = false;
}

bool GroupMeter::update(const ScaleFactors& total, Group& out) noexcept {
  if (total.blocks < due_) return false;
  due_ = total.blocks + kGroupBlocks;
  if (!has_law_) {
    law_ = Profile::make(total, kAllScales);
    has_law_ = law_.fit.ok;
    if (has_law_) before_ = gram_of(total, law_);
    return false;
  }
  const Gram now = gram_of(total, law_);
  const Gram g = now - before_;
  before_ = now;
  return level_of(g, law_.fit.theta[Model::kWidthChange], out);
}

double ChangeWatch::deviation(std::size_t which) const noexcept {
  if (learnt_ < 2) return 0.0;
  return std::sqrt(tracks_[which].squares / static_cast<double>(learnt_ - 1));
}

void ChangeWatch::learn(const Pair& value) noexcept {
  ++learnt_;
  for (std::size_t i = 0; i < value.size(); ++i) {
    Track& track = tracks_[i];
    const double off = value[i] - track.mean;
    track.mean += off / static_cast<double>(learnt_);
    track.squares += off * (value[i] - track.mean);
  }
}

bool ChangeWatch::judge(std::size_t which, double off, std::int64_t& first) noexcept {
  Track& track = tracks_[which];
  const double allowed = std::max(config_.allowance, config_.sigmas * deviation(which));
  const double most = kMostOfThreshold * config_.threshold;
  const auto add = [&](double& sum, double beyond, std::int64_t& began) {
    if (sum <= 0.0) began = groups_;
    sum = std::max(sum + std::min(beyond, most), 0.0);
  };
  add(track.up, off - allowed, track.up_first);
  add(track.down, -off - allowed, track.down_first);
  first = track.up > 0.0 ? track.up_first : track.down_first;
  // Rounding of three parts must not make a fourth.
  return std::max(track.up, track.down) > (1.0 - 1e-9) * config_.threshold;
}

double ChangeWatch::mean_since(std::size_t which, std::int64_t first) const noexcept {
  const std::int64_t from = std::max(first, groups_ - static_cast<std::int64_t>(kKept) + 1);
  double sum = 0.0;
  for (std::int64_t group = from; group <= groups_; ++group)
    sum += newest_[static_cast<std::size_t>(group) % kKept][which];
  return sum / static_cast<double>(groups_ - from + 1);
}

ChangeAlarm ChangeWatch::alarm(std::size_t which, std::int64_t first) const noexcept {
  const double own = mean_since(which, first);
  const double other = mean_since(1 - which, first);
  const bool both = own * other > 0.0 && std::abs(other) > kLeastShare * std::abs(own) &&
                    std::abs(own) > kLeastShare * std::abs(other);
  if (both) return {DriftingParameter::kMass, first, groups_, std::expm1(-0.5 * (own + other))};
  return {which == 0 ? DriftingParameter::kFriction : DriftingParameter::kStiffness, first, groups_,
          std::expm1(own)};
}

bool ChangeWatch::update(double friction, double stiffness, ChangeAlarm& out) noexcept {
  if (!(friction > 0.0 && stiffness > 0.0)) return false;
  const Pair value{std::log(friction), std::log(stiffness)};
  ++groups_;
  if (learnt_ < config_.least) {
    learn(value);
    return false;
  }
  for (std::size_t i = 0; i < value.size(); ++i)
    newest_[static_cast<std::size_t>(groups_) % kKept][i] = value[i] - tracks_[i].mean;
  bool quiet = true;
  for (std::size_t i = 0; i < value.size(); ++i) {
    std::int64_t first = 0;
    if (judge(i, value[i] - tracks_[i].mean, first)) {
      out = alarm(i, first);
      tracks_ = {};
      learnt_ = 0;
      return true;
    }
    quiet = quiet && tracks_[i].up <= 0.0 && tracks_[i].down <= 0.0;
  }
  if (quiet && learnt_ < config_.learn) learn(value);
  return false;
}

}  // namespace dampline
