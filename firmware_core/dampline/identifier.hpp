// SPDX-License-Identifier: MIT
// The way of one frame, in the order in which it flows:
//
//   push(frame) -> assembler -> bridge -> placer -> guard -> judgement delay -> reference low pass
//               -> estimator (screen, motion, rows, sums)
//                                                        -> { effects | phase | density | alarms }
//   snapshot(), faults(), alarms(), statistics(), explanation(): what is known, at any moment
//
// A file, a live bus, the surrogate of a record, the benchmarks and your firmware go through here.
#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "dampline/can_frame.hpp"
#include "dampline/config.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/effect/explainer.hpp"
#include "dampline/faults.hpp"
#include "dampline/guard/alarm_watch.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/guard/judgement_delay.hpp"
#include "dampline/motion/reference_low_pass.hpp"
#include "dampline/phase/view.hpp"
#include "dampline/result.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/sample/hole_bridge.hpp"
#include "dampline/sample/placer.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// What an Identifier has beside the estimate. A part that is not wanted takes neither memory nor
/// time; docs/api.md tells what each takes.
struct Parts {
  bool frames{true};     ///< push(CanFrame): decoding, channels brought together by counter or time
  bool guards{true};     ///< faults are named, holes bridged; samples wait until they are judged
  bool densities{true};  ///< of y and v, and the Fokker-Planck criterion
  bool phase{true};      ///< the planes of (y, y', y'')
  bool alarms{true};     ///< a parameter that is not what it was
  bool effects{false};   ///< the sums from which explanation() names what the model lacks
};

/// As `dampline identify` runs a file, and as `dampline explain` and a live run do.
inline constexpr Parts kIdentifyParts{};
inline constexpr Parts kExplainParts{.effects = true};
/// Frames to curve, faults named: what a controller needs, and what dampline.h has.
inline constexpr Parts kEmbeddedParts{.densities = false, .phase = false, .alarms = false};
/// Samples to curve and nothing beside.
inline constexpr Parts kEstimateParts{
    .frames = false, .guards = false, .densities = false, .phase = false, .alarms = false};
/// Samples to curve and to the sums of the effects: a surrogate, a record whose faults are known.
inline constexpr Parts kDiagnosisParts{.frames = false,
                                       .guards = false,
                                       .densities = false,
                                       .phase = false,
                                       .alarms = false,
                                       .effects = true};

/// Sees what goes through a corridor, for tables and plots. Both are called within push().
template <class T>
concept StreamObserver = requires(T observer, const Sample& sample, const UpdateResult& result) {
  observer.taken(sample);           // as it came in, holes bridged
  observer.judged(sample, result);  // when the guards had judged it, and what became of it
};

struct NoObserver {
  void taken(const Sample& /*unused*/) const noexcept {}
  void judged(const Sample& /*unused*/, const UpdateResult& /*unused*/) const noexcept {}
};

/// What the parts make of a configuration.
[[nodiscard]] AssemblerConfig assembler_config(const IdentifierConfig& config) noexcept;
[[nodiscard]] GuardConfig guard_config(const IdentifierConfig& config) noexcept;
[[nodiscard]] std::size_t delay_samples(const IdentifierConfig& config) noexcept;
/// The same rate, nodes and filter; a sliding window becomes forgetting of the same mean age.
[[nodiscard]] FokkerPlanckConfig density_config(const EstimatorConfig& config) noexcept;

/// The corridor: frames or samples of one truck in, what is known out. Everything about the stream
/// lives in here: its size is fixed, push() costs a bounded number of operations, allocates
/// nothing and reads no clock. 0.5 to 9 MB, by its parts: place it yourself, not on the stack.
///
/// EstimatorOfIt: Estimator, or SmallEstimator, which has no motion for the parts behind it.
template <Parts kParts, class EstimatorOfIt = Estimator>
class BasicIdentifier {
  static_assert(EstimatorOfIt::kHasMotion ||
                !(kParts.densities || kParts.phase || kParts.alarms || kParts.effects));

 public:
  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<IdentifierConfig> check(const IdentifierConfig& config) noexcept;
  /// Precondition: check(config).ok(). `grids`: of the effects, those of another record or the
  /// ordinary ones.
  explicit BasicIdentifier(const IdentifierConfig& config, const effect::Grids& grids = {}) noexcept
      : config_{config},
        estimator_{config.estimator},
        assembler_{frames_config(config)},
        placer_{config.estimator.sample_rate_hz},
        guard_{guard_config(config)},
        delay_{delay_samples(config)},
        low_pass_{config.estimator.anti_alias, config.estimator.sample_rate_hz},
        density_{density_config(config.estimator)},
        phase_{PhaseViewConfig{.sample_rate_hz = config.estimator.sample_rate_hz}},
        alarms_{config.estimator},
        effects_{config.estimator, grids} {}

  /// One frame, whoever sent it.
  template <StreamObserver Observer = const NoObserver>
  void push(const CanFrame& frame, Observer& observer = kNobody) requires(kParts.frames) {
    assembler_.push(frame);
    take_complete(observer);
  }
  /// One sample; ticks increase.
  template <StreamObserver Observer = const NoObserver>
  void push(const Sample& sample, Observer& observer = kNobody) {
    if constexpr (kParts.guards) {
      bridge_.push(sample);
      bridge(observer);
    } else {
      observer.taken(sample);
      use(sample, observer);
    }
  }
  /// No more frames: what is complete is taken.
  template <StreamObserver Observer = const NoObserver>
  void flush(Observer& observer = kNobody) requires(kParts.frames) {
    assembler_.flush();
    take_complete(observer);
  }
  /// The end of the stream: takes what still waits and closes the open blocks. Done once.
  template <StreamObserver Observer = const NoObserver>
  void finish(Observer& observer = kNobody) {
    if constexpr (kParts.frames) flush(observer);
    if constexpr (kParts.guards) {
      bridge_.finish();
      bridge(observer);
      placer_.finish();
      judge(observer);
      guard_.finish();
      for (Sample due; delay_.drain(guard_, due);) use(due, observer);
    }
    estimator_.finish();
    if constexpr (kParts.effects) effects_.finish();
  }

  /// Level, stiffness, curve and deviations. Some 10^6 operations: on demand, not per sample.
  [[nodiscard]] Snapshot snapshot() noexcept { return estimator_.snapshot(); }
  /// Level and stiffness alone, for much less.
  [[nodiscard]] Level level() noexcept { return estimator_.level(); }
  /// The sufficient statistics, some 270 KiB: place them yourself.
  void statistics(Statistics& out) noexcept requires(EstimatorOfIt::kHasStatistics) {
    estimator_.export_statistics(out);
  }
  [[nodiscard]] FaultView faults() const noexcept requires(kParts.guards) {
    FaultView out;
    for (const Fault& fault : guard_.faults()) out.faults[out.count++] = fault;
    out.inputs = guard_.inputs();
    out.repairs = delay_.counts();
    out.repairs.bridged = bridge_.figures();
    out.repairs.placed = placer_.figures();
    out.frame_follow = guard_.frame_follow();
    out.misplacement = guard_.misplacement();
    return out;
  }
  [[nodiscard]] const AlarmView& alarms() const noexcept requires(kParts.alarms) {
    return alarms_.view();
  }
  /// What the model lacks. Some 10^8 operations: not beside a stream; see effect::StoreCopy for
  /// that. `explainer`: the place where it is worked out, some MB.
  [[nodiscard]] effect::Explanation explanation(effect::Explainer& explainer,
                                                const effect::ExplainerConfig& config) const
      requires(kParts.effects) {
    return explainer.explain(effects_, config);
  }

  [[nodiscard]] const IdentifierConfig& config() const noexcept { return config_; }
  [[nodiscard]] EstimatorOfIt& estimator() noexcept { return estimator_; }
  [[nodiscard]] const SampleAssembler& assembler() const noexcept { return assembler_; }
  [[nodiscard]] const Guard& guard() const noexcept { return guard_; }
  [[nodiscard]] const FokkerPlanck& density() const noexcept { return density_; }
  [[nodiscard]] const PhaseView& phase() const noexcept { return phase_; }
  [[nodiscard]] const effect::Diagnosis& effects() const noexcept { return effects_; }
  /// The effects' sums of all blocks that are closed, in the middle of a stream: not in one that
  /// must keep up.
  void gather_effects() noexcept requires(kParts.effects) { effects_.gather(); }

 private:
  static constexpr NoObserver kNobody{};
  struct None {
    template <class... Args>
    explicit None(const Args&... /*unused*/) noexcept {}
  };
  template <bool kPresent, class T>
  using If = std::conditional_t<kPresent, T, None>;

  [[nodiscard]] static AssemblerConfig frames_config(const IdentifierConfig& config) noexcept {
    AssemblerConfig out = assembler_config(config);
    if constexpr (kParts.guards) out.most_missing = HoleBridge::kMostMissing;
    return out;
  }
  template <class Observer>
  void take_complete(Observer& observer) {
    for (Sample sample; assembler_.pop(sample);) push(sample, observer);
  }
  template <class Observer>
  void bridge(Observer& observer) {
    for (Sample sample; bridge_.pop(sample);) {
      observer.taken(sample);
      if (sample.bridged != 0) guard_.set_bridged(bridge_.figures());
      placer_.push(sample);
      judge(observer);
    }
  }
  template <class Observer>
  void judge(Observer& observer) {
    for (Sample taken, placed; placer_.pop(taken, placed);) {
      guard_.update(placed, taken.accel_mps2);
      if (Sample due; delay_.push(placed, guard_, due)) use(due, observer);
    }
  }
  template <class Observer>
  void use(const Sample& sample, Observer& observer) {
    const Sample& seen = low_pass_.update(sample);
    const UpdateResult result = estimator_.update(seen);
    if constexpr (kParts.effects) effects_.update(seen, result);
    if (result.has_motion) {
      if constexpr (kParts.phase) phase_.update(result.motion);
      if constexpr (kParts.densities) density_.update(result.motion);
    }
    if constexpr (kParts.alarms)
      if (result.block_closed) alarms_.take(result.block, sample.tick, estimator_);
    observer.judged(sample, result);
  }

  IdentifierConfig config_;
  EstimatorOfIt estimator_;
  If<kParts.frames, SampleAssembler> assembler_;
  If<kParts.guards, HoleBridge> bridge_{};
  If<kParts.guards, SamplePlacer> placer_;
  If<kParts.guards, Guard> guard_;
  If<kParts.guards, JudgementDelay> delay_;
  ReferenceLowPass low_pass_;
  If<kParts.densities, FokkerPlanck> density_;
  If<kParts.phase, PhaseView> phase_;
  If<kParts.alarms, AlarmWatch> alarms_;
  If<kParts.effects, effect::Diagnosis> effects_;
};

/// The way of a frame as `dampline identify` runs it.
using Identifier = BasicIdentifier<kIdentifyParts>;
/// Its estimate and its faults, to the last bit.
using EmbeddedIdentifier = BasicIdentifier<kEmbeddedParts>;
/// Samples to curve for a controller of 128 KiB: state and stack (docs/api.md, small parts).
using SmallIdentifier = BasicIdentifier<kEstimateParts, SmallEstimator>;
static_assert(sizeof(SmallIdentifier) <= 107UL * 1024);

template <Parts kParts, class EstimatorOfIt>
Result<IdentifierConfig> BasicIdentifier<kParts, EstimatorOfIt>::check(
    const IdentifierConfig& config) noexcept {
  const bool usable = EstimatorOfIt::check(config.estimator).ok() &&
                      (!kParts.frames || SampleAssembler::check(assembler_config(config)).ok()) &&
                      (!kParts.guards || Guard::check(guard_config(config)).ok()) &&
                      config.judgement_delay_s >= 0.0;
  if (!usable) return Errc::kInvalidConfig;
  return config;
}

}  // namespace dampline
