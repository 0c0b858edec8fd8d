// SPDX-License-Identifier: MIT
#include "dampline/phase/view.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kClippedShare = 0.01;

/// Whether the mass covers more than one column, and more than one row.
bool varies(const PhasePicture& picture) noexcept {
  std::array<bool, kPictureCells> columns{};
  std::array<bool, kPictureCells> rows{};
  std::size_t column_count = 0;
  std::size_t row_count = 0;
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      if (!(picture.density[i][j] > 0.0F)) continue;
      column_count += columns[i] ? 0U : 1U;
      row_count += rows[j] ? 0U : 1U;
      columns[i] = true;
      rows[j] = true;
    }
  }
  return column_count > 1 && row_count > 1;
}

constexpr double kMeterRateHz = 50.0;  // of the period meter: lags of 20 ms, up to 10 s
constexpr double kLookEveryS = 10.0;
constexpr double kMaxDrift = 0.05;  // of a period, between the sections' flashes and the motion
// Bins to begin with where ranges are learned: far below any motion.
constexpr double kDeflectionM = 1e-7;
constexpr double kVelocityMps = 1e-6;
constexpr double kAccelMps2 = 1e-5;

BinRange range(double low, double high, double resolution, const PhaseViewConfig& config) noexcept {
  if (low != high) return {.low = low, .high = high};
  const auto warm_up = static_cast<std::uint32_t>(config.learn_s * config.sample_rate_hz);
  return {.resolution = resolution, .warm_up_samples = std::max<std::uint32_t>(warm_up, 1U)};
}

struct Ranges {
  BinRange deflection, velocity, accel;
  explicit Ranges(const PhaseViewConfig& c) noexcept
      : deflection{range(c.deflection_low_m, c.deflection_high_m, kDeflectionM, c)},
        velocity{range(c.velocity_low_mps, c.velocity_high_mps, kVelocityMps, c)},
        accel{range(c.accel_low_mps2, c.accel_high_mps2, kAccelMps2, c)} {}
};

JointHistogramConfig plane(const BinRange& x, const BinRange& y) noexcept {
  return {.x = x, .y = y};
}

int decimation(double sample_rate_hz) noexcept {
  return std::max(1, static_cast<int>(std::lround(sample_rate_hz / kMeterRateHz)));
}

Stroboscope stroboscope(double period_s, double first_s, double step_s) noexcept {
  const StroboscopeConfig config{period_s, first_s, static_cast<int>(kSectionPhases)};
  return Stroboscope::make(config, 1.5 * step_s).value();
}

}  // namespace

void make_picture(const PictureHistogram& histogram, PhasePicture& out) noexcept {
  out.x_low = histogram.x_axis().low();
  out.x_high = histogram.x_axis().high();
  out.y_low = histogram.y_axis().low();
  out.y_high = histogram.y_axis().high();
  out.samples = histogram.samples();
  out.outside_share = histogram.share_outside();
  for (std::size_t i = 0; i < kPictureCells; ++i)
    for (std::size_t j = 0; j < kPictureCells; ++j)
      out.density[i][j] = static_cast<float>(histogram.density(i, j));
  if (out.samples == 0)
    out.state = PictureState::kEmpty;
  else if (out.outside_share > kClippedShare)
    out.state = PictureState::kClipped;
  else
    out.state = varies(out) ? PictureState::kGood : PictureState::kConstant;
}

Result<PhaseViewConfig> PhaseView::check(const PhaseViewConfig& config) noexcept {
  const double step_s = 1.0 / config.sample_rate_hz;
  const bool valid =
      config.sample_rate_hz > 0.0 && std::isfinite(config.sample_rate_hz) && config.learn_s > 0.0 &&
      config.learn_s < 1e6 && config.known_period_s >= 0.0 &&
      std::isfinite(config.known_period_s) &&
      (config.known_period_s == 0.0 || config.known_period_s > 2.0 * kSectionPhases * step_s);
  if (!valid) return Errc::kInvalidConfig;
  const Ranges ranges{config};
  for (const BinRange& r : {ranges.deflection, ranges.velocity, ranges.accel})
    if (!BinAxis<kPictureCells>::valid(r)) return Errc::kInvalidConfig;
  return config;
}

PhaseView::PhaseView(const PhaseViewConfig& config) noexcept
    : config_{config},
      step_s_{1.0 / config.sample_rate_hz},
      velocity_over_deflection_{plane(Ranges{config}.deflection, Ranges{config}.velocity)},
      accel_over_deflection_{plane(Ranges{config}.deflection, Ranges{config}.accel)},
      accel_over_velocity_{plane(Ranges{config}.velocity, Ranges{config}.accel)},
      meter_{1.0 / config.sample_rate_hz, decimation(config.sample_rate_hz)},
      stroboscope_{stroboscope(1.0, 0.0, 1.0 / config.sample_rate_hz)},
      until_look_{static_cast<std::uint64_t>(kLookEveryS * config.sample_rate_hz)} {
  if (config_.known_period_s > 0.0) start_sections(config_.known_period_s);
}

void PhaseView::update(const Motion& motion) noexcept {
  const PhasePoint p{motion.deflection_m, motion.velocity_mps, motion.relative_mps2};
  if (!is_finite(p)) {
    ++not_finite_;
    has_last_ = false;
    return;
  }
  if (!has_last_ || motion.tick != last_tick_ + 1) {
    meter_.restart();
    stroboscope_.restart();
  }
  has_last_ = true;
  last_tick_ = motion.tick;
  meter_.update(p.velocity_mps);
  if (motion.still) {
    ++still_;
  } else {
    velocity_over_deflection_.update(p.deflection_m, p.velocity_mps);
    accel_over_deflection_.update(p.deflection_m, p.accel_mps2);
    accel_over_velocity_.update(p.velocity_mps, p.accel_mps2);
  }
  if (strobes_) {
    const SectionPoint hit = stroboscope_.update(step_s_ * static_cast<double>(motion.tick), p);
    if (hit.taken) {
      Ring& ring = rings_[static_cast<std::size_t>(hit.phase)];
      ring.points[ring.count++ % kSectionPoints] = hit.point;
    }
  }
  if (--until_look_ > 0) return;
  until_look_ = static_cast<std::uint64_t>(kLookEveryS * config_.sample_rate_hz);
  look_for_period();
}

/// A detected period that has moved so far that the flashes would drift over the sections starts
/// them anew; one that is gone ends them.
void PhaseView::look_for_period() noexcept {
  if (config_.known_period_s > 0.0) return;
  const Period period = meter_.period();
  if (period.state != PeriodState::kFound) return stop_sections();
  const double strobed_s = stroboscope_.config().period_s;
  const double now_s = step_s_ * static_cast<double>(last_tick_);
  const double periods = (now_s - strobed_since_s_) / strobed_s;
  if (!strobes_ || std::abs(period.period_s - strobed_s) * periods > kMaxDrift * strobed_s)
    start_sections(period.period_s);
}

void PhaseView::start_sections(double period_s) noexcept {
  strobes_ = true;
  strobed_since_s_ = step_s_ * static_cast<double>(last_tick_);
  stroboscope_ = stroboscope(period_s, strobed_since_s_, step_s_);
  for (Ring& ring : rings_) ring.count = 0;
}

void PhaseView::stop_sections() noexcept {
  strobes_ = false;
  for (Ring& ring : rings_) ring.count = 0;
}

void PhaseView::snapshot(PhaseSnapshot& out) const noexcept {
  make_picture(velocity_over_deflection_, out.velocity_over_deflection);
  make_picture(accel_over_deflection_, out.accel_over_deflection);
  make_picture(accel_over_velocity_, out.accel_over_velocity);
  out.still = still_;
  out.not_finite = not_finite_;
  out.period_is_known = config_.known_period_s > 0.0;
  out.period = out.period_is_known ? meter_.confirm(config_.known_period_s) : meter_.period();
  const bool is_there = out.period.state == PeriodState::kFound ||
                        (out.period_is_known && out.period.state == PeriodState::kNotEnough);
  for (std::size_t phase = 0; phase < kSectionPhases; ++phase) {
    const Ring& ring = rings_[phase];
    const std::uint64_t first = ring.count > kSectionPoints ? ring.count - kSectionPoints : 0;
    out.section_count[phase] = is_there ? static_cast<std::size_t>(ring.count - first) : 0;
    if (!is_there) continue;
    for (std::uint64_t i = first; i < ring.count; ++i)
      out.section[phase][static_cast<std::size_t>(i - first)] = ring.points[i % kSectionPoints];
  }
}

}  // namespace dampline
