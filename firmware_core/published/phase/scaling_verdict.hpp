// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "published/phase/section_means.hpp"

namespace dampline {

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

}  // namespace dampline
