// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/phase/stroboscope.hpp"

namespace dampline {

/// Mean and variance of one quantity (Welford).
class RunningMean {
 public:
  void add(double x) noexcept {
    ++count_;
    const double from_old = x - mean_;
    mean_ += from_old / static_cast<double>(count_);
    squares_ += from_old * (x - mean_);
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean() const noexcept { return mean_; }
  /// Of one sample; 0 with fewer than two.
  [[nodiscard]] double variance() const noexcept {
    return count_ < 2 ? 0.0 : squares_ / static_cast<double>(count_ - 1);
  }

 private:
  std::uint64_t count_{0};
  double mean_{0.0};
  double squares_{0.0};
};

/// The sections of one steady response: per phase the mean point and its scatter, and the input.
template <int Phases>
struct SectionMeans {
  struct AtPhase {
    RunningMean deflection_m, velocity_mps, accel_mps2, input;
  };
  std::array<AtPhase, static_cast<std::size_t>(Phases)> phases{};

  /// Points that are no number, or of a phase that is not there, are left out.
  void add(int phase, const PhasePoint& p, double input) noexcept {
    if (phase < 0 || phase >= Phases || !is_finite(p) || !std::isfinite(input)) return;
    AtPhase& at = phases[static_cast<std::size_t>(phase)];
    at.deflection_m.add(p.deflection_m);
    at.velocity_mps.add(p.velocity_mps);
    at.accel_mps2.add(p.accel_mps2);
    at.input.add(input);
  }
};

enum class ScalingState : std::uint8_t {
  kNotEnough,     ///< fewer than three periods at some phase
  kNoInput,       ///< an input that does not swing
  kSameInput,     ///< the inputs differ by less than 10 %: nothing to compare
  kOtherShape,    ///< the inputs are not in proportion to each other
  kNoMotion,      ///< neither run moves
  kProportional,  ///< as a linear system's
  kDisproportional
};

/// Chi-square per degree of freedom above which the responses are not in proportion, and the share
/// of the response that the departure must reach.
inline constexpr double kScalingThreshold = 10.0;
inline constexpr double kScalingLeastDeparture = 0.01;

struct ScalingVerdict {
  ScalingState state{ScalingState::kNotEnough};
  double input_ratio{0.0};  ///< large over small
  double departure{0.0};    ///< rms of (large - ratio small) over rms of the larger of the two
  double departure_std{0.0};
  double chi2{0.0};  ///< per degree of freedom
  int degrees{0};
};

/// Sums of products of two swings.
struct Swings {
  double small2{0.0}, large2{0.0}, both{0.0};
};

/// How far one channel's large response is from the ratio times the small one.
struct Departure {
  double squares{0.0};   ///< of the departure
  double response{0.0};  ///< squares of the larger of the two, for scale
  double noise{0.0};     ///< expected squares from scatter alone
  int degrees{0};
};

struct ScalingSums {
  double chi2{0.0};
  double share2{0.0};  ///< of departure, relative, summed over channels
  double noise2{0.0};
  int degrees{0};
  int channels{0};
  void add(const Departure& d) noexcept;
};

/// One channel of two runs, phase by phase.
template <int Phases>
struct ChannelPair {
  std::array<RunningMean, static_cast<std::size_t>(Phases)> small{}, large{};

  [[nodiscard]] bool enough() const noexcept {
    const auto few = [](const RunningMean& m) { return m.count() < 3; };
    return std::none_of(small.begin(), small.end(), few) &&
           std::none_of(large.begin(), large.end(), few);
  }

  [[nodiscard]] Swings swings() const noexcept {
    const double from_small = average(small);
    const double from_large = average(large);
    Swings out;
    for (std::size_t i = 0; i < small.size(); ++i) {
      const double s = small[i].mean() - from_small;
      const double l = large[i].mean() - from_large;
      out.small2 += s * s;
      out.large2 += l * l;
      out.both += s * l;
    }
    return out;
  }

  [[nodiscard]] Departure departure(double ratio) const noexcept {
    const Swings s = swings();
    Departure out{.squares = s.large2 - 2.0 * ratio * s.both + ratio * ratio * s.small2,
                  .response = std::max(s.large2, ratio * ratio * s.small2),
                  .degrees = Phases - 1};
    for (std::size_t i = 0; i < small.size(); ++i) {
      const double n = variance_of_mean(large[i]) + ratio * ratio * variance_of_mean(small[i]);
      out.noise += n * (Phases - 1) / Phases;
    }
    return out;
  }

 private:
  static double average(const std::array<RunningMean, static_cast<std::size_t>(Phases)>& means) {
    double sum = 0.0;
    for (const RunningMean& m : means) sum += m.mean();
    return sum / Phases;
  }
  static double variance_of_mean(const RunningMean& m) noexcept {
    return m.variance() / static_cast<double>(m.count());
  }
};

/// kProportional: the inputs can be compared, and input_ratio is set.
[[nodiscard]] ScalingVerdict judge_input(const Swings& input) noexcept;
[[nodiscard]] ScalingVerdict judge_departure(ScalingVerdict out, const ScalingSums& sums) noexcept;

/// Test whether the steady response grows in proportion to its input: of two runs at the same
/// frequency, the deflection, velocity and acceleration at each phase, less their means over the
/// phases, must have the ratio that the inputs have. Not for the sample path.
template <int Phases>
[[nodiscard]] ScalingVerdict judge_scaling(const SectionMeans<Phases>& small,
                                           const SectionMeans<Phases>& large) noexcept {
  static_assert(Phases >= 4);
  using At = typename SectionMeans<Phases>::AtPhase;
  const auto pick = [&](RunningMean At::*channel) {
    ChannelPair<Phases> pair;
    for (std::size_t i = 0; i < pair.small.size(); ++i) {
      pair.small[i] = small.phases[i].*channel;
      pair.large[i] = large.phases[i].*channel;
    }
    return pair;
  };
  const ChannelPair<Phases> input = pick(&At::input);
  if (!input.enough()) return {};
  ScalingVerdict out = judge_input(input.swings());
  if (out.state != ScalingState::kProportional) return out;
  ScalingSums sums;
  for (RunningMean At::*channel : {&At::deflection_m, &At::velocity_mps, &At::accel_mps2})
    sums.add(pick(channel).departure(out.input_ratio));
  return judge_departure(out, sums);
}

}  // namespace dampline
