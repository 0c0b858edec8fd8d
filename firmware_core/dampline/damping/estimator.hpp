// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "dampline/basis/columns.hpp"
#include "dampline/config.hpp"
#include "dampline/damping/turn.hpp"
#include "dampline/estimate/block_ledger.hpp"
#include "dampline/estimate/block_store.hpp"
#include "dampline/estimate/grouped_store.hpp"
#include "dampline/estimate/statistics.hpp"
#include "dampline/motion/anti_alias.hpp"
#include "dampline/motion/drift_free_integral.hpp"
#include "dampline/motion/noise_meter.hpp"
#include "dampline/result.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/screen.hpp"
#include "dampline/snapshot.hpp"
#include "dampline/wavelet/row_builder.hpp"

namespace dampline {

struct UpdateResult {
  bool has_motion{false};
  Motion motion{};  ///< of an earlier sample
  bool block_closed{false};
  BlockReport block{};
};

/// What an estimator keeps, and how.
struct FullEstimate {
  using Rows = FullRows;
  using Store = BlockStore;
  static constexpr bool kHasMotion = true;  ///< UpdateResult::motion
};
/// For controllers of 128 KiB: at most 300 Hz, no sliding window, no motion and no statistics to
/// merge; rows in single precision, deviations from 16 entries of grouped scales
/// (docs/adr/0012-small-parts.md).
struct SmallEstimate {
  using Rows = SmallRows;
  using Store = GroupedStore;
  static constexpr bool kHasMotion = false;
};

/// The corridor: a sample in, what is known out. Everything about one stream lives in here; its
/// size is fixed, update() costs a bounded number of operations, allocates nothing and reads no
/// clock.
///
/// M z_b'' + k y + F(v) = 0 with y = 2 z_b - (z_1 + z_2), v = y'.
template <class Kind>
class BasicEstimator {
 public:
  static constexpr double kBlockS = 2.0;
  static constexpr bool kHasMotion = Kind::kHasMotion;
  static constexpr bool kHasStatistics = std::is_same_v<typename Kind::Store, BlockStore>;
  static constexpr double kMaxRateHz = Kind::Rows::kMostHz;

  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<EstimatorConfig> check(const EstimatorConfig& config) noexcept;

  /// Precondition: check(config).ok().
  explicit BasicEstimator(const EstimatorConfig& config) noexcept;

  UpdateResult update(const Sample& sample) noexcept;

  /// The end of a record: takes the samples that are still held back and closes the open blocks.
  void finish() noexcept;
  /// Reports that finish() left behind; false when there is none.
  [[nodiscard]] bool next_report(BlockReport& out) noexcept { return reports_.pop(out); }

  [[nodiscard]] Snapshot snapshot() noexcept;
  /// The level and the stiffness of snapshot() alone, for much less work.
  [[nodiscard]] Level level() noexcept;

  /// The sufficient statistics so far. `out` is some 270 KiB: place it yourself.
  void export_statistics([[maybe_unused]] Statistics& out) noexcept requires(kHasStatistics) {
    if constexpr (kHasStatistics) {  // clang 14 compiles what is not wanted, too
      store_.finish();
      out.header = header();
      store_.total_to(out.total);
      std::array<const ScaleFactors*, kEntries> entries{};
      const std::size_t count = store_.entries_to(entries);
      for (std::size_t i = 0; i < count; ++i) out.entries[i] = *entries[i];
      for (std::size_t i = count; i < kEntries; ++i) out.entries[i].clear();
      out.header.entry_count = static_cast<std::uint32_t>(count);
    }
  }
  /// The sums over all blocks alone, some 9 KiB.
  void export_total(ScaleFactors& out) noexcept {
    store_.summed_up([&out](const ScaleFactors& total, auto /*entries*/) { out = total; });
  }
  /// Starts new statistics; filters and open blocks go on. Two exports around this call merge to
  /// what one export without it would have been.
  void clear_statistics() noexcept;

  /// From a sample to its velocity, to its Motion, and to the last row that it is the centre of.
  [[nodiscard]] double velocity_latency_s() const noexcept;
  [[nodiscard]] double motion_latency_s() const noexcept requires(kHasMotion) {
    if constexpr (kHasMotion) return velocity_latency_s() + deflection_.delay() * step_s_;
    return 0.0;
  }
  [[nodiscard]] double row_latency_s() const noexcept;

  [[nodiscard]] const EstimatorConfig& config() const noexcept { return config_; }

 private:
  static constexpr std::size_t kHistory = 1024;
  struct None {
    template <class... Args>
    explicit None(const Args&... /*unused*/) noexcept {}
  };
  template <class T>
  using OfMotion = std::conditional_t<kHasMotion, T, None>;

  void take(const Screened& screened, UpdateResult& result) noexcept;
  void take_motion(std::int64_t n, double velocity_mps, bool still, UpdateResult& result) noexcept;
  void count_fault(Verdict verdict, std::int64_t block) noexcept;
  void take_gap(std::int64_t tick) noexcept;
  void start_stretch(std::int64_t tick) noexcept;
  void process(const Sample& sample, UpdateResult& result) noexcept;
  void choose_corner() noexcept;
  void take_velocity(std::int64_t n, double velocity_mps, UpdateResult& result) noexcept;
  void set_corner(Baseline::Corner corner) noexcept;
  void take_law(std::int64_t n, LawColumns::Lanes columns, bool still) noexcept;
  void take_turned(std::int64_t n) noexcept;
  void count_velocity(double velocity_mps, bool still) noexcept;
  void begin_raster(std::int64_t first_law) noexcept;
  void build_rows(std::int64_t newest) noexcept;
  void build_row(std::size_t scale, std::int64_t centre) noexcept;
  void close_blocks_before(std::int64_t block) noexcept;
  [[nodiscard]] StatisticsHeader header() const noexcept;
  [[nodiscard]] std::int64_t block_of(std::int64_t tick) const noexcept {
    return tick / block_ticks_;
  }
  [[nodiscard]] static std::size_t history(std::int64_t n) noexcept {
    return static_cast<std::size_t>(n) % kHistory;
  }
  [[nodiscard]] static ScreenConfig screen_config(const EstimatorConfig& config) noexcept;
  [[nodiscard]] std::int64_t velocity_delay() const noexcept {
    return VelocityLift::kHalf + velocity_.delay();
  }
  /// Of the law's columns behind the velocity: a frame's turn is known later.
  [[nodiscard]] std::int64_t law_lag() const noexcept {
    if constexpr (kHasMotion) return pitch_share_ > 0.0 ? turn_.delay() : 0;
    return 0;
  }
  [[nodiscard]] std::uint64_t basis_hash() const noexcept;

  EstimatorConfig config_;
  double step_s_;
  std::int64_t block_ticks_;
  std::int64_t row_reach_{0};  // samples from the centre of the longest row to the newest it needs
  std::uint32_t rows_per_block_{0};
  double far_share_{0.0};  // of the moving mass
  double pitch_share_{0.0};
  bool turn_known_{false};

  static_assert(stuck_samples(kMaxRateHz) <= 80.0);
  BasicSampleScreen<80> screen_;
  Fir<VelocityLift::kHalf> lift_;
  DriftFreeIntegral velocity_;
  OfMotion<DriftFreeIntegral> deflection_;
  NoiseMeter noise_;
  bool corner_chosen_{false};
  LawColumns law_;
  LawAverage average_;
  OfMotion<TurnPath> turn_;
  BasicRowBuilder<typename Kind::Rows> rows_;
  BlockLedger ledger_;
  typename Kind::Store store_;

  bool any_{false};      // a sample was given
  bool started_{false};  // a sample came through the screen
  bool in_stretch_{false};
  std::int64_t newest_tick_{0};           // given to update()
  std::int64_t last_tick_{0};             // through the screen
  std::int64_t stretch_tick_{0};          // tick of the stretch's sample 0
  std::int64_t count_{0};                 // samples of the stretch
  std::int64_t first_law_{0};             // first sample of the stretch with the law's columns
  std::array<int, kScales> until_row_{};  // samples until the next centre of each scale
  std::int64_t open_block_{0};            // oldest block that may still get rows
  double activity_{0.0};                  // smoothed v^2, (m/s)^2
  double input_activity_{0.0};  // smoothed squared change of the wheelsets' mean, (m/s^2)^2
  double last_input_mps2_{0.0};

  BlockReports reports_;

  VelocityCounts velocity_counts_;
  Counts counts_;
  // Rings, by sample of the stretch.
  std::array<typename Kind::Rows::Number, kHistory> accel_mps2_{};  // y'' with its fast part lifted
  OfMotion<std::array<double, kHistory>> velocity_mps_{};
  OfMotion<std::array<bool, kHistory>> still_{};
};

using Estimator = BasicEstimator<FullEstimate>;
using SmallEstimator = BasicEstimator<SmallEstimate>;

}  // namespace dampline
