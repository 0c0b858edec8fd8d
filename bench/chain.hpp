// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>

#include "app/identify/can_channels.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/methods.hpp"
#include "dampline/phase/view.hpp"
#include "dampline/sample/assembler.hpp"

namespace dampline::bench {

enum class Parts : std::uint8_t {
  kEstimate,   ///< decode, checks, motion, wavelet rows, estimate
  kDensities,  ///< and the densities
  kIdentify,   ///< and phase planes and guards, as `dampline identify` runs it
  kExplain     ///< and the sums that judge every candidate effect, as `dampline explain` runs it
};

/// The project's own sensors.
inline AssemblerConfig frame_config() { return app::can_channels(app::Config{}); }

inline EstimatorConfig chain_config() {
  EstimatorConfig config;
  config.screen = app::screen_of(frame_config().channels);
  config.screen.sample_rate_hz = config.sample_rate_hz;
  return config;
}

inline GuardConfig guard_config() {
  const EstimatorConfig core = chain_config();
  GuardConfig config;
  config.step_mps2 = core.screen.step_mps2;
  return config;
}

/// Frames of one truck to its estimate, one thread. Place it on the heap.
template <Parts kParts>
class Chain {
 public:
  Chain() : Chain(frame_config(), chain_config(), guard_config()) {}
  /// The frames of one sampling instant.
  void push(const std::array<CanFrame, kChannels>& frames) noexcept {
    Sample sample;
    for (const CanFrame& frame : frames) {
      assembler_.push(frame);
      while (assembler_.pop(sample)) take(sample);
    }
  }
  void take(const Sample& sample) noexcept {
    if constexpr (kCompanions) guard_.update(sample);
    const UpdateResult result = identifier_.update(sample);
    if constexpr (kCompanions)
      if (result.has_motion) phase_.update(result.motion);
    if constexpr (kParts >= Parts::kDensities) methods_.update(result);
    if constexpr (kParts == Parts::kExplain) diagnosis_.update(sample, result);
  }
  [[nodiscard]] Estimator& identifier() noexcept { return identifier_; }

 private:
  struct None {
    template <class... Args>
    explicit None(const Args&... /*unused*/) noexcept {}
  };
  template <bool kPresent, class T>
  using If = std::conditional_t<kPresent, T, None>;
  static constexpr bool kCompanions = kParts >= Parts::kIdentify;

  Chain(const AssemblerConfig& frames, const EstimatorConfig& core, const GuardConfig& guard)
      : assembler_{frames},
        identifier_{core},
        guard_{guard},
        phase_{PhaseViewConfig{}},
        methods_{core},
        diagnosis_{core} {}

  SampleAssembler assembler_;
  Estimator identifier_;
  If<kCompanions, Guard> guard_;
  If<kCompanions, PhaseView> phase_;
  If<(kParts >= Parts::kDensities), Methods> methods_;
  If<kParts == Parts::kExplain, effect::Diagnosis> diagnosis_;
};

}  // namespace dampline::bench
