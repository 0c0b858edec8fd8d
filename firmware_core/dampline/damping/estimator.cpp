// SPDX-License-Identifier: MIT
#include "dampline/damping/estimator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dampline/damping/summary.hpp"
#include "dampline/motion/reference_low_pass.hpp"
#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

using Cause = BlockLedger::Fault;

constexpr double kMinRateHz = 149.85;  // 150, as a clock that is 0.1 % off measures it
constexpr double kStillMps = 2.0e-3;
constexpr double kQuietInputMps2 = 0.2;  // rms change of the wheelsets' mean from sample to sample
constexpr double kStickMps = 2.0e-3;
constexpr double kActivityTimeS = 0.25;
constexpr double kStillShareLimit = 0.5;
constexpr std::int64_t kCornerDecision = 600;  // samples of noise before the corner is chosen
constexpr double kNoiseForHighCornerMps2 = 0.05;

std::size_t nearest_node(const std::array<double, kCurveSegments>& nodes, double speed) noexcept {
  std::size_t i = 0;
  while (i + 1 < kCurveSegments && speed > 0.5 * (nodes[i] + nodes[i + 1])) ++i;
  return i;
}

constexpr std::uint64_t kBasisVersion = 1;

double corner_hz(Baseline::Corner corner) noexcept {
  return corner == Baseline::Corner::k0p7Hz ? 0.7 : 1.0;
}

/// FNV-1a over the bits of a number.
std::uint64_t hashed(std::uint64_t hash, double value) noexcept {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int shift = 0; shift < 64; shift += 8) {
    hash = (hash ^ ((bits >> shift) & 0xffU)) * 0x100000001b3ULL;
  }
  return hash;
}

}  // namespace

template <class Kind>
Result<EstimatorConfig> BasicEstimator<Kind>::check(const EstimatorConfig& config) noexcept {
  const double rate = config.sample_rate_hz;
  if (!(rate >= kMinRateHz && rate <= kMaxRateHz)) return Errc::kInvalidConfig;
  if (!(config.moving_mass_kg > 0.0) || !std::isfinite(config.moving_mass_kg)) {
    return Errc::kInvalidConfig;
  }
  for (const double extra_kg : {config.far_mass_kg, config.frame_pitch_mass_kg})
    if (!(extra_kg >= 0.0) || !std::isfinite(extra_kg)) return Errc::kInvalidConfig;
  if (config.frame_pitch_mass_kg > 0.0 && !kHasMotion) return Errc::kInvalidConfig;
  const double corner = config.velocity_corner_hz;
  if (corner != 0.0 && corner != 0.7 && corner != 1.0) return Errc::kInvalidConfig;
  double left = 0.0;
  for (const double node : config.curve_nodes_mps) {
    if (!(node > left && node < 10.0)) return Errc::kInvalidConfig;
    left = node;
  }
  if (!decltype(screen_)::check(screen_config(config)).ok()) return Errc::kInvalidConfig;
  if (!config.anti_alias.is_usable()) return Errc::kInvalidConfig;
  if (config.memory == Memory::kWindow && !Kind::Store::kHasWindow) return Errc::kInvalidConfig;
  if (config.memory != Memory::kInfinite &&
      !(config.memory_s >= kBlockS && std::isfinite(config.memory_s))) {
    return Errc::kInvalidConfig;
  }
  return config;
}

template <class Kind>
BasicEstimator<Kind>::BasicEstimator(const EstimatorConfig& config) noexcept
    : config_{config},
      step_s_{1.0 / config.sample_rate_hz},
      block_ticks_{std::lround(kBlockS * config.sample_rate_hz)},
      screen_{screen_config(config)},
      lift_{VelocityLift{ReferenceLowPass::seen_behind(config.anti_alias), config.sample_rate_hz}
                .taps()},
      velocity_{config.sample_rate_hz},
      deflection_{config.sample_rate_hz},
      law_{config.curve_nodes_mps},
      turn_{VelocityLift{ReferenceLowPass::seen_behind(config.anti_alias), config.sample_rate_hz}
                .taps(),
            config.sample_rate_hz},
      rows_{config.sample_rate_hz},
      store_{{.memory = config.memory, .memory_blocks = config.memory_s / kBlockS}} {
  far_share_ = config.far_mass_kg / config.moving_mass_kg;
  pitch_share_ = config.frame_pitch_mass_kg / config.moving_mass_kg;
  row_reach_ = velocity_delay() + law_lag() + rows_.bank().half(0) + 2;
  for (std::size_t s = 0; s < kScales; ++s) {
    rows_per_block_ += static_cast<std::uint32_t>(block_ticks_ / rows_.bank().stride(s));
  }
  if (config.velocity_corner_hz != 0.0) {
    set_corner(config.velocity_corner_hz > 0.85 ? Baseline::Corner::k1p0Hz
                                                : Baseline::Corner::k0p7Hz);
  }
}

template <class Kind>
ScreenConfig BasicEstimator<Kind>::screen_config(const EstimatorConfig& config) noexcept {
  ScreenConfig screen = config.screen;
  screen.sample_rate_hz = config.sample_rate_hz;
  return screen;
}

template <class Kind>
UpdateResult BasicEstimator<Kind>::update(const Sample& sample) noexcept {
  UpdateResult result;
  if (any_ && sample.tick <= newest_tick_) {
    ++counts_.repeated;
    return result;
  }
  any_ = true;
  newest_tick_ = sample.tick;
  ++counts_.samples;
  Screened screened;
  if (screen_.push(sample, screened)) take(screened, result);
  store_.step();
  result.block_closed = reports_.pop(result.block);
  return result;
}

template <class Kind>
void BasicEstimator<Kind>::take(const Screened& screened, UpdateResult& result) noexcept {
  const std::int64_t tick = screened.sample.tick;
  if (started_ && tick != last_tick_ + 1) take_gap(tick);
  if (!started_) open_block_ = block_of(tick);
  started_ = true;
  last_tick_ = tick;
  if (screened.verdict == Verdict::kGood) {
    if (!in_stretch_) start_stretch(tick);
    process(screened.sample, result);
  } else {
    in_stretch_ = false;
    count_fault(screened.verdict, block_of(tick));
  }
  // A block's last row needs the samples of its reach on the far side.
  close_blocks_before(block_of(std::max<std::int64_t>(tick - row_reach_, 0)));
}

template <class Kind>
void BasicEstimator<Kind>::count_fault(Verdict verdict, std::int64_t block) noexcept {
  switch (verdict) {
    case Verdict::kGood:
      return;
    case Verdict::kSpoilt:
      return ledger_.mark(block, Cause::kSpoilt);
    case Verdict::kStuck:
      ++counts_.stuck;
      return ledger_.mark(block, Cause::kStuck);
    case Verdict::kSaturated:
      ++counts_.saturated;
      return ledger_.mark(block, Cause::kSaturated);
    case Verdict::kNotFinite:
      ++counts_.not_finite;
      return ledger_.mark(block, Cause::kNotFinite);
  }
}

template <class Kind>
void BasicEstimator<Kind>::take_gap(std::int64_t tick) noexcept {
  ++counts_.gaps;
  counts_.lost += static_cast<std::uint64_t>(tick - last_tick_ - 1);
  ledger_.mark(block_of(last_tick_ + 1), Cause::kGap);
  ledger_.mark(block_of(tick - 1), Cause::kGap);
  in_stretch_ = false;
  // Nothing reaches across a gap: what lies before it gets no more rows, what was skipped has none.
  close_blocks_before(std::min(block_of(last_tick_ + 1) + 1, block_of(tick)));
  open_block_ = std::max(open_block_, block_of(tick));
}

template <class Kind>
void BasicEstimator<Kind>::start_stretch(std::int64_t tick) noexcept {
  in_stretch_ = true;
  stretch_tick_ = tick;
  count_ = 0;
  first_law_ = -1;
  lift_.reset();
  velocity_.reset();
  if constexpr (kHasMotion) deflection_.reset();
  noise_.reset();
  average_.reset();
  if constexpr (kHasMotion) turn_.reset();
}

template <class Kind>
DAMPLINE_WIDE void BasicEstimator<Kind>::process(const Sample& sample,
                                                 UpdateResult& result) noexcept {
  const auto& a = sample.accel_mps2;
  const double relative_mps2 = 2.0 * a[0] - a[1] - a[2];
  const std::int64_t n = count_++;
  rows_.set_accelerations(n, pushed_mps2(sample, far_share_), relative_mps2);
  noise_.update(a[0]);
  const double input_mps2 = 0.5 * (a[1] + a[2]);
  const double change_mps2 = input_mps2 - last_input_mps2_;
  input_activity_ += (change_mps2 * change_mps2 - input_activity_) * step_s_ / kActivityTimeS;
  last_input_mps2_ = input_mps2;
  choose_corner();
  if constexpr (kHasMotion)
    if (pitch_share_ > 0.0) turn_known_ = turn_.take(sample, n);
  double accel_mps2 = 0.0;
  if (!lift_.update(relative_mps2, accel_mps2)) return;
  accel_mps2_[history(n - VelocityLift::kHalf)] =
      static_cast<typename Kind::Rows::Number>(accel_mps2);
  double velocity_mps = 0.0;
  if (velocity_.update(accel_mps2, velocity_mps)) {
    take_velocity(n - velocity_delay(), velocity_mps, result);
  }
}

template <class Kind>
void BasicEstimator<Kind>::choose_corner() noexcept {
  if (corner_chosen_ || noise_.count() < kCornerDecision) return;
  const bool noisy = noise_.std() > kNoiseForHighCornerMps2;
  set_corner(noisy ? Baseline::Corner::k1p0Hz : Baseline::Corner::k0p7Hz);
}

template <class Kind>
void BasicEstimator<Kind>::set_corner(Baseline::Corner corner) noexcept {
  velocity_.set_corner(corner);
  if constexpr (kHasMotion) turn_.set_corner(corner);
  corner_chosen_ = true;
}

template <class Kind>
void BasicEstimator<Kind>::take_velocity(std::int64_t n, double velocity_mps,
                                         UpdateResult& result) noexcept {
  activity_ += (velocity_mps * velocity_mps - activity_) * step_s_ / kActivityTimeS;
  const bool still =
      activity_ < kStillMps * kStillMps || input_activity_ < kQuietInputMps2 * kQuietInputMps2;
  count_velocity(velocity_mps, still);
  if constexpr (kHasMotion) {
    take_motion(n, velocity_mps, still, result);
    if (pitch_share_ > 0.0) {
      if (turn_known_) take_turned(n - law_lag());
      return;
    }
  }
  take_law(n, average_.update(law_, velocity_mps, accel_mps2_[history(n)], step_s_), still);
}

/// Sample n, which is law_lag() behind the newest velocity: the frame's turn is known now.
template <class Kind>
void BasicEstimator<Kind>::take_turned([[maybe_unused]] std::int64_t n) noexcept {
  if constexpr (kHasMotion) {
    const double velocity_mps = velocity_mps_[history(n)];
    auto columns = average_.update(law_, velocity_mps, accel_mps2_[history(n)], step_s_);
    const Turn turn = turn_.mean(n, velocity_mps);
    columns[kTurnSpringLane] = static_cast<float>(turn.spring_m);
    columns[kTurnPushLane] = static_cast<float>(pitch_share_ * turn.push_mps2);
    take_law(n, columns, still_[history(n)]);
  }
}

template <class Kind>
void BasicEstimator<Kind>::take_law(std::int64_t n, LawColumns::Lanes columns,
                                    bool still) noexcept {
  if (!average_.complete()) return;
  if (first_law_ < 0) begin_raster(n - 1);
  rows_.set_law(n - 1, columns, still);
  build_rows(n - 1);
}

template <class Kind>
void BasicEstimator<Kind>::take_motion([[maybe_unused]] std::int64_t n,
                                       [[maybe_unused]] double velocity_mps,
                                       [[maybe_unused]] bool still,
                                       [[maybe_unused]] UpdateResult& result) noexcept {
  if constexpr (kHasMotion) {
    velocity_mps_[history(n)] = velocity_mps;
    still_[history(n)] = still;
    double deflection_m = 0.0;
    if (!deflection_.update(velocity_mps, deflection_m)) return;
    const std::int64_t then = n - deflection_.delay();
    result.has_motion = true;
    result.motion = {.tick = stretch_tick_ + then,
                     .deflection_m = deflection_m,
                     .velocity_mps = velocity_mps_[history(then)],
                     .frame_mps2 = rows_.frame_mps2(then),
                     .relative_mps2 = rows_.relative_mps2(then),
                     .still = still_[history(then)]};
  }
}

template <class Kind>
void BasicEstimator<Kind>::count_velocity(double velocity_mps, bool still) noexcept {
  if (still) return;
  const double speed = std::abs(velocity_mps);
  ++velocity_counts_.moving;
  if (speed < kStickMps) ++velocity_counts_.sticking;
  velocity_counts_.sum_squares += speed * speed;
  auto& side = velocity_mps > 0.0 ? velocity_counts_.positive : velocity_counts_.negative;
  ++side[nearest_node(config_.curve_nodes_mps, speed)];
}

// Centres lie on a fixed raster of ticks, of its own phase per scale: stride / 2.
template <class Kind>
void BasicEstimator<Kind>::begin_raster(std::int64_t first_law) noexcept {
  first_law_ = first_law;
  for (std::size_t s = 0; s < kScales; ++s) {
    const int stride = rows_.bank().stride(s);
    const std::int64_t phase = (stretch_tick_ + first_law - rows_.bank().half(s)) % stride;
    const auto at = static_cast<int>(phase < 0 ? phase + stride : phase);
    until_row_[s] = (stride / 2 - at + stride) % stride + 1;
  }
}

template <class Kind>
void BasicEstimator<Kind>::build_rows(std::int64_t newest) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) {
    if (--until_row_[s] > 0) continue;
    until_row_[s] = rows_.bank().stride(s);
    const int half = rows_.bank().half(s);
    const std::int64_t centre = newest - half;
    if (centre - half >= first_law_) build_row(s, centre);
  }
}

template <class Kind>
void BasicEstimator<Kind>::build_row(std::size_t scale, std::int64_t centre) noexcept {
  const std::int64_t block = block_of(stretch_tick_ + centre);
  if (rows_.still_share(scale, centre) > kStillShareLimit) {
    ledger_.add_still_row(block);
    ++counts_.rows_still;
    return;
  }
  ledger_.add_row(block);
  ++counts_.rows;
  store_.absorb(block, scale, rows_.row(scale, centre));
}

template <class Kind>
void BasicEstimator<Kind>::close_blocks_before(std::int64_t block) noexcept {
  for (; open_block_ < block; ++open_block_) {
    const BlockStatus status =
        ledger_.close(open_block_, rows_per_block_ - static_cast<std::uint32_t>(kScales));
    reports_.push({.first_tick = open_block_ * block_ticks_, .status = status});
    ++counts_.blocks;
    if (status == BlockStatus::kStill) ++counts_.blocks_still;
    if (status >= BlockStatus::kExcludedGap) ++counts_.blocks_excluded;
    store_.close(open_block_);
  }
}

template <class Kind>
void BasicEstimator<Kind>::finish() noexcept {
  UpdateResult result;
  Screened screened;
  while (screen_.drain(screened)) take(screened, result);
  if (started_) close_blocks_before(block_of(last_tick_) + 1);
  store_.finish();
}

template <class Kind>
StatisticsHeader BasicEstimator<Kind>::header() const noexcept {
  return {.basis_hash = basis_hash(),
          .sample_rate_hz = config_.sample_rate_hz,
          .velocity_corner_hz = corner_hz(velocity_.corner()),
          .curve_nodes_mps = config_.curve_nodes_mps,
          .entry_count = 0,
          .blocks_per_entry = store_.blocks_per_entry(),
          .velocity = velocity_counts_,
          .noise_mps2 = noise_.std(),
          .newest_tick = newest_tick_,
          .counts = counts_};
}

template <class Kind>
Snapshot BasicEstimator<Kind>::snapshot() noexcept {
  return store_.summed_up([this](const ScaleFactors& total, auto entries) {
    return summarise(header(), total, entries, {.moving_mass_kg = config_.moving_mass_kg});
  });
}

template <class Kind>
Level BasicEstimator<Kind>::level() noexcept {
  return store_.summed_up([this](const ScaleFactors& total, auto entries) {
    return summarise_level(header(), total, entries, {.moving_mass_kg = config_.moving_mass_kg});
  });
}

template <class Kind>
void BasicEstimator<Kind>::clear_statistics() noexcept {
  store_.clear();
  velocity_counts_ = {};
  counts_ = {};
}

template <class Kind>
double BasicEstimator<Kind>::velocity_latency_s() const noexcept {
  return static_cast<double>(velocity_delay() + static_cast<std::int64_t>(screen_.delay())) *
         step_s_;
}

template <class Kind>
double BasicEstimator<Kind>::row_latency_s() const noexcept {
  return static_cast<double>(row_reach_ + static_cast<std::int64_t>(screen_.delay())) * step_s_;
}

template <class Kind>
std::uint64_t BasicEstimator<Kind>::basis_hash() const noexcept {
  std::uint64_t hash = hashed(0xcbf29ce484222325ULL, static_cast<double>(kBasisVersion));
  hash = hashed(hash, config_.sample_rate_hz);
  hash = hashed(hash, corner_hz(velocity_.corner()));
  for (const double w : kLawWidthMps) hash = hashed(hash, w);
  for (const double node : config_.curve_nodes_mps) hash = hashed(hash, node);
  hash = hashed(hash, config_.anti_alias.corner_hz);
  hash = hashed(hash, config_.anti_alias.order);
  for (const double own_hz : config_.anti_alias.own_hz)
    if (own_hz > 0.0) hash = hashed(hash, own_hz);
  for (std::size_t s = 0; s < kScales; ++s) hash = hashed(hash, rows_.bank().half(s));
  if (pitch_share_ > 0.0) hash = hashed(hash, pitch_share_);
  if (far_share_ > 0.0) hash = hashed(hash, far_share_);
  return hash;
}

template class BasicEstimator<FullEstimate>;
template class BasicEstimator<SmallEstimate>;

}  // namespace dampline
