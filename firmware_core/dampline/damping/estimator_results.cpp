// SPDX-License-Identifier: MIT
// What is known so far: the Estimator's results and statistics. The path of a sample is in
// estimator.cpp.
#include <bit>

#include "dampline/damping/estimator.hpp"
#include "dampline/damping/summary.hpp"

namespace dampline {
namespace {

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
  for (std::size_t s = 0; s < kScales; ++s) hash = hashed(hash, rows_.bank().half(s));
  if (pitch_share_ > 0.0) hash = hashed(hash, pitch_share_);
  if (far_share_ > 0.0) hash = hashed(hash, far_share_);
  return hash;
}

}  // namespace dampline
