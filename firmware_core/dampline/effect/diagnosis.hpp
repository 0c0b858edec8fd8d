// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/damping/estimator.hpp"
#include "dampline/effect/gram_store.hpp"
#include "dampline/effect/laws.hpp"
#include "dampline/effect/modes.hpp"
#include "dampline/effect/rows.hpp"
#include "dampline/estimate/velocity_error.hpp"
#include "dampline/motion/anti_alias.hpp"

namespace dampline::effect {

/// What an explanation is made of.
struct Sums {
  const GramStore& store;
  const ImpulseMeter& impulses;
  const Grids& grids;
  VelocityError velocity;
  double deflection_rms_m{0.0};  ///< over the moving samples
};

/// The sums that judge every candidate effect, gathered beside the estimate: the Estimator's
/// companion, fed with each sample and with what the Estimator made of it. Its size is fixed;
/// update() costs a bounded number of operations, allocates nothing and changes nothing in the
/// Estimator.
class Diagnosis {
 public:
  /// Motion before the lengths of the candidates are fixed, s; it is not part of the sums.
  static constexpr double kLearningS = 8.0;

  /// Precondition: Estimator::check(config).ok().
  /// `grids`: those of another record, or the ordinary ones; their scale is learnt where it is 0.
  explicit Diagnosis(const EstimatorConfig& config, const Grids& grids = {}) noexcept;

  void update(const Sample& sample, const UpdateResult& result) noexcept;
  /// The end of a record: closes the open blocks.
  void finish() noexcept;
  /// Does at once what is still to be done of the closed blocks and is spread over samples
  /// otherwise; changes no sum.
  void gather() noexcept { store_.finish(); }

  [[nodiscard]] const ImpulseMeter& impulses() const noexcept { return impulses_; }
  [[nodiscard]] const GramStore& store() const noexcept { return store_; }
  /// The tick whose sampled columns the newest update() made; negative: it made none.
  [[nodiscard]] std::int64_t column_tick() const noexcept { return column_tick_; }
  /// The sampled columns of a row at column_tick().
  [[nodiscard]] const Rows::Sampled& columns() const noexcept { return rows_.values(column_tick_); }
  [[nodiscard]] const RawRing& raw() const noexcept { return raw_; }
  /// The deflection's size: its rms over the learning time, rounded to a half power of two of a
  /// millimetre so that records share their grids. 0 until it is known.
  [[nodiscard]] double scale_m() const noexcept { return scale_known_ ? grids().scale_m : 0.0; }
  [[nodiscard]] const Grids& grids() const noexcept { return mean_.grids(); }
  /// Means over the moving samples.
  [[nodiscard]] double velocity_rms_mps() const noexcept;
  [[nodiscard]] double deflection_rms_m() const noexcept;
  [[nodiscard]] VelocityError velocity_error() const noexcept {
    return {sample_rate_hz_, velocity_rms_mps()};
  }
  [[nodiscard]] Sums sums() const noexcept {
    return {store_, impulses_, grids(), velocity_error(), deflection_rms_m()};
  }

 private:
  void take(const Motion& motion) noexcept;
  void restart(const Motion& motion) noexcept;
  bool learn(const Motion& motion) noexcept;
  [[nodiscard]] Instant instant_of(const Motion& motion) noexcept;
  [[nodiscard]] double lifted_mps2(std::int64_t tick) const noexcept;
  void build_rows(std::int64_t newest) noexcept;
  void close_before(std::int64_t block) noexcept;
  [[nodiscard]] std::int64_t block_of(std::int64_t tick) const noexcept {
    return tick / block_ticks_;
  }

  double sample_rate_hz_;
  std::int64_t block_ticks_;
  VelocityLift::Taps lift_;
  double pitch_share_;
  TurnMean turn_;
  RawRing raw_;
  Rows rows_;
  GramStore store_;
  ImpulseMeter impulses_;
  LawMean mean_;
  std::array<Resonator, kFlexibleModes> flexible_;
  Rows::Sampled last_bend_ = Rows::Sampled::Zero();  // of the resonators, two samples
  Rows::Sampled before_last_ = Rows::Sampled::Zero();

  std::int64_t learnt_{0};
  double learnt_squares_{0.0};
  std::int64_t column_tick_{-1};
  std::int64_t last_tick_{0};
  std::int64_t first_row_tick_{0};  // first tick of the stretch with columns
  std::int64_t open_block_{0};
  double moving_{0.0};
  double velocity_squares_{0.0};
  double deflection_squares_{0.0};
  bool still_{false};
  bool scale_known_{false};
  bool in_stretch_{false};
  bool any_block_{false};
};

}  // namespace dampline::effect
