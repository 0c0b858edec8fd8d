// SPDX-License-Identifier: MIT
#include "dampline/damping/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dampline/basis/smooth_sign.hpp"
#include "dampline/damping/curve.hpp"
#include "dampline/estimate/law_profile.hpp"
#include "dampline/estimate/velocity_error.hpp"

namespace dampline {
namespace {

// Errors that the scatter of the blocks does not show, of the value itself: discretisation of the
// law, the shape of the law near v = 0, correlated velocity errors.
constexpr double kCoulombFloor = 0.0025;
constexpr double kStiffnessFloor = 0.0030;
constexpr double kViscousFloor = 0.0030;  // of Fc / v_rms
// Of a curve: the velocity's own error bends it, the more the nearer its width.
constexpr double kCurveFloor = 0.0025;
constexpr double kWidthShare = 0.03;  // at the width
constexpr double kUnseen = 0.15;      // of the force that the width hides
// The 32 Hz scale fits between sticks and sharpens the friction law, but knows nothing of
// stiffness.
constexpr ScaleMask kLongScales{true, true, true, true, false};
constexpr double kValidStickShare = 0.25;
// The bent law's level counts from the one share on, alone from the other on.
constexpr double kBendsFrom = 0.15;
constexpr double kBendsWholly = 0.25;
// What sticking leaves of bias, of the value, for each unit of the share beyond.
constexpr double kCoulombSticks = 0.05;
constexpr double kCoulombSticksFrom = 0.12;
constexpr double kCurveSticksNear = 2.0;  // so many times more where a node is near the width
constexpr double kStiffnessSticks = 0.32;
constexpr double kStiffnessSticksFrom = 0.18;
constexpr double kValidWidthMps = 10.0e-3;
constexpr std::size_t kFolds = 5;
constexpr std::size_t kFewestEntries = 4;  // below, a deviation says nothing

double floored(double std, double floor) noexcept { return std::sqrt(std * std + floor * floor); }

double beyond(double share, double from) noexcept { return std::max(share - from, 0.0); }

/// `floor`, `of_sticking`: shares of the value.
double with_floors(const Estimate& e, double floor, double of_sticking) noexcept {
  return floored(floored(e.std, floor * e.value), of_sticking * e.value);
}

double stick_share(const VelocityCounts& v) noexcept {
  return v.moving > 0 ? static_cast<double>(v.sticking) / static_cast<double>(v.moving) : 0.0;
}

double velocity_rms_mps(const VelocityCounts& v) noexcept {
  return v.moving > 0 ? std::sqrt(v.sum_squares / static_cast<double>(v.moving)) : 0.0;
}

template <class Entries>
struct Context {
  const StatisticsHeader& header;
  const ScaleFactors& total;
  Entries entries;
  double mass_kg{0.0};
  double blocks_factor{1.0};
  VelocityError velocity;
};

/// What one model says: friction from all scales, stiffness from the long ones.
template <bool Viscous>
struct LawResult {
  using Profile = LawProfile<Viscous>;
  using Model = typename Profile::Model;
  using Deviations = typename WeightedFit<Model::kUnknowns>::Vector;
  Profile law;
  Estimate coulomb, stiffness, width, viscous;
  double nmse{0.0};
  double held_out_nmse{0.0};
  bool ok{false};

  template <class Entries>
  static LawResult make(const Context<Entries>& c) noexcept {
    LawResult out = without_errors(c);
    if (!out.ok) return out;
    out.nmse = out.law.fit.weighted_residual / out.law.fit.weighted_total;
    out.held_out_nmse = c.entries.size() >= kFolds ? held_out_nmse_of<Model::kUnknowns, kFolds>(
                                                         out.law.fit, c.entries, out.law.map)
                                                   : std::numeric_limits<double>::quiet_NaN();
    return out;
  }

  /// Both errors left out.
  template <class Entries>
  static LawResult without_errors(const Context<Entries>& c) noexcept {
    LawResult out;
    out.law = Profile::make(c.total, kAllScales);
    const auto long_law = Profile::make(c.total, kLongScales);
    out.ok = out.law.fit.ok && long_law.fit.ok;
    if (!out.ok) return out;
    const auto& theta = out.law.fit.theta;
    const Deviations std = deviations<Model::kUnknowns>(c, out.law.fit, out.law.map);
    const double coulomb = theta[Model::kCoulomb];
    const double share = stick_share(c.header.velocity);
    out.coulomb = unbiased(c, out.law.width_index, {coulomb, std[Model::kCoulomb]}, share);
    out.coulomb.std =
        with_floors(out.coulomb, kCoulombFloor, kCoulombSticks * beyond(share, kCoulombSticksFrom));
    out.stiffness = {
        long_law.fit.theta[Model::kStiffness],
        deviations<Model::kUnknowns>(c, long_law.fit, long_law.map)[Model::kStiffness]};
    out.stiffness.std = with_floors(out.stiffness, kStiffnessFloor,
                                    kStiffnessSticks * beyond(share, kStiffnessSticksFrom));
    const double width_mps = out.law.width_mps();
    out.coulomb = c.velocity.coulomb(out.coulomb, width_mps);
    out.stiffness = c.velocity.stiffness(out.stiffness, width_mps);
    out.width = {width_mps, std[Model::kWidthChange] / coulomb * out.law.span_mps()};
    if constexpr (Viscous) out.viscous = {theta[Model::kViscous], std[Model::kViscous]};
    return out;
  }

 private:
  template <int Q, class Entries>
  static typename WeightedFit<Q>::Vector deviations(const Context<Entries>& c,
                                                    const WeightedFit<Q>& fit,
                                                    const ColumnMap<Q>& map) noexcept {
    const auto covariance = score_covariance<Q>(fit, c.entries, map);
    return c.blocks_factor * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }

  /// The level where the truck sticks: more and more that of the bent law.
  template <class Entries>
  static Estimate unbiased(const Context<Entries>& c, std::size_t width_index,
                           const Estimate& level, double share) noexcept {
    using Bent = LawModel<Viscous, true>;
    const double bent_share =
        std::clamp((share - kBendsFrom) / (kBendsWholly - kBendsFrom), 0.0, 1.0);
    if (bent_share == 0.0 || !Bent::can_bend(width_index)) return level;
    const auto map = Bent::free_width(width_index);
    const auto fit = weighted_fit<Bent::kUnknowns>(c.total, map, kAllScales);
    if (!fit.ok) return level;
    const double std = deviations<Bent::kUnknowns>(c, fit, map)[Bent::kCoulomb];
    return {std::lerp(level.value, fit.theta[Bent::kCoulomb], bent_share),
            std::lerp(level.std, std, bent_share)};
  }
};

Estimate operator*(double factor, const Estimate& e) noexcept {
  return {factor * e.value, factor * e.std};
}

void fill_law(double mass_kg, const LawResult<false>& law, Snapshot& out) noexcept {
  out.coulomb_n = mass_kg * law.coulomb;
  out.stiffness_npm = mass_kg * law.stiffness;
  out.law_width_mps = law.width;
  out.nmse = law.nmse;
  out.held_out_nmse = law.held_out_nmse;
}

void fill_viscous(double mass_kg, const LawResult<true>& law, Snapshot& out) noexcept {
  const double floor =
      out.velocity_rms_mps > 0.0 ? kViscousFloor * law.coulomb.value / out.velocity_rms_mps : 0.0;
  out.viscous_nspm = mass_kg * Estimate{law.viscous.value, floored(law.viscous.std, floor)};
  out.coulomb_with_viscous_n = mass_kg * law.coulomb;
  out.stiffness_with_viscous_npm = mass_kg * law.stiffness;
  out.law_width_with_viscous_mps = law.width;
  out.nmse_with_viscous = law.nmse;
  out.held_out_nmse_with_viscous = law.held_out_nmse;
}

/// The broken line holds any viscous part, so its jump has the width of the model that has one.
template <class Entries>
void fill_curve(const Context<Entries>& c, const LawProfile<true>& law, Snapshot& out) noexcept {
  const auto curve = CurveFit::make(c.total, c.entries, law, kAllScales, c.header.curve_nodes_mps);
  if (!curve.fit.ok) return;
  const double jump = curve.fit.theta[CurveFit::kJump];
  const double jump_std = std::sqrt(curve.covariance(CurveFit::kJump, CurveFit::kJump));
  out.curve_force_at_zero_n = c.mass_kg * jump;
  out.curve_std_at_zero_n = c.mass_kg * floored(c.blocks_factor * jump_std, kCoulombFloor * jump);
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const double v_mps = c.header.curve_nodes_mps[i];
    const Estimate f = curve.force(v_mps, c.header.curve_nodes_mps);
    const double near = law.width_mps() / v_mps;
    const double unseen = kUnseen * (1.0 - smooth_sign(v_mps, law.width_mps()));
    const double sticks = (1.0 + kCurveSticksNear * near) * kCoulombSticks *
                          beyond(out.stick_share, kCoulombSticksFrom);
    const double floor = floored(floored(floored(kCurveFloor, kWidthShare * near), sticks), unseen);
    const Estimate stated = c.velocity.coulomb(
        {f.value, floored(c.blocks_factor * f.std, floor * f.value)}, law.width_mps());
    out.curve[i] = {.velocity_mps = v_mps,
                    .force_n = c.mass_kg * stated.value,
                    .std_n = c.mass_kg * stated.std,
                    .samples = c.header.velocity.positive[i]};
    out.samples_negative[i] = c.header.velocity.negative[i];
  }
}

template <class Entries>
Context<Entries> context_of(const StatisticsHeader& header, const ScaleFactors& total,
                            Entries entries, const SummaryConfig& config) noexcept {
  return {.header = header,
          .total = total,
          .entries = entries,
          .mass_kg = config.moving_mass_kg,
          .blocks_factor = short_record_factor(static_cast<double>(entries.size())),
          .velocity = {header.sample_rate_hz, velocity_rms_mps(header.velocity)}};
}

void fill_motion(const StatisticsHeader& header, Snapshot& out) noexcept {
  out.velocity_rms_mps = velocity_rms_mps(header.velocity);
  out.stick_share = stick_share(header.velocity);
  out.noise_mps2 = header.noise_mps2;
}

}  // namespace

template <class Entries>
Snapshot summarise(const StatisticsHeader& header, const ScaleFactors& total, Entries entries,
                   const SummaryConfig& config) noexcept {
  Snapshot out;
  out.tick = header.newest_tick;
  out.counts = header.counts;
  out.blocks_in_estimate = total.blocks;
  if (header.counts.blocks > 0) {
    out.excitation = 1.0 - static_cast<double>(header.counts.blocks_still) /
                               static_cast<double>(header.counts.blocks);
  }
  fill_motion(header, out);
  if (entries.size() < kFewestEntries) return out;
  const auto context = context_of(header, total, entries, config);
  const auto law = LawResult<false>::make(context);
  const auto viscous_law = LawResult<true>::make(context);
  out.valid = law.ok && viscous_law.ok;
  if (!out.valid) return out;
  fill_law(context.mass_kg, law, out);
  fill_viscous(context.mass_kg, viscous_law, out);
  fill_curve(context, viscous_law.law, out);
  const bool sticks = out.stick_share > kValidStickShare;
  out.std_is_lower_bound = sticks || law.width.value > kValidWidthMps;
  out.std_with_viscous_is_lower_bound = sticks || viscous_law.width.value > kValidWidthMps;
  return out;
}

template <class Entries>
Level summarise_level(const StatisticsHeader& header, const ScaleFactors& total, Entries entries,
                      const SummaryConfig& config) noexcept {
  if (entries.size() < kFewestEntries) return {};
  const auto context = context_of(header, total, entries, config);
  const auto law = LawResult<false>::without_errors(context);
  if (!law.ok) return {};
  return {.valid = true,
          .coulomb_n = context.mass_kg * law.coulomb,
          .stiffness_npm = context.mass_kg * law.stiffness};
}

template Snapshot summarise(const StatisticsHeader&, const ScaleFactors&, EntryList,
                            const SummaryConfig&) noexcept;
template Snapshot summarise(const StatisticsHeader&, const ScaleFactors&, GroupedList,
                            const SummaryConfig&) noexcept;
template Level summarise_level(const StatisticsHeader&, const ScaleFactors&, EntryList,
                               const SummaryConfig&) noexcept;
template Level summarise_level(const StatisticsHeader&, const ScaleFactors&, GroupedList,
                               const SummaryConfig&) noexcept;

namespace {

/// Where the entries of statistics lie.
struct Listed {
  explicit Listed(const Statistics& statistics) noexcept : count{statistics.header.entry_count} {
    for (std::size_t i = 0; i < kEntries; ++i) entries[i] = &statistics.entries[i];
  }
  [[nodiscard]] EntryList list() const noexcept { return EntryList{entries}.first(count); }
  std::array<const ScaleFactors*, kEntries> entries{};
  std::size_t count;
};

}  // namespace

Snapshot summarise(const Statistics& statistics, const SummaryConfig& config) noexcept {
  return summarise(statistics.header, statistics.total, Listed{statistics}.list(), config);
}

Level summarise_level(const Statistics& statistics, const SummaryConfig& config) noexcept {
  return summarise_level(statistics.header, statistics.total, Listed{statistics}.list(), config);
}

}  // namespace dampline
