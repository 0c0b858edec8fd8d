// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "app/diagnosis/truck/surrogates.hpp"
#include "app/live/handover.hpp"
#include "dampline/effect/gram_store.hpp"

namespace dampline::app {

/// How much of what a live run's model leaves no effect can take away: surrogates that go along
/// with the run, in the explainer's thread. Where the law has changed they begin anew with the
/// newest minutes of motion, which are kept. All memory is the constructor's.
class LiveFloor {
 public:
  /// Of motion that is kept, s: some 90 blocks, and a second of work where the law has changed.
  static constexpr double kKeptS = 180.0;
  static constexpr std::size_t kRoom = 32768;  // 109 s at 300 Hz

  explicit LiveFloor(const EstimatorConfig& core);

  // The acquisition's side.
  /// A sample that was judged, in motion. False: there is no room; the surrogates have a gap there.
  [[nodiscard]] bool take(const Sample& sample) noexcept { return ring_.push(sample); }

  // The explainer's side.
  /// Takes what came.
  void follow();
  /// One sample that did not come that way.
  void follow(const Sample& sample);
  /// The motion that is kept, the oldest first; a copy.
  [[nodiscard]] std::vector<Sample> kept() const;
  /// Floor and conclusion of an explanation of these sums. False: as Surrogates::hold_against().
  [[nodiscard]] bool hold_against(const effect::GramStore& sums, const GuardedNoise& guarded,
                                  effect::Explainer& explainer, Explained& out);
  [[nodiscard]] const FrameNoise& noise() const noexcept { return noise_; }
  /// Whatever law there was: the next one begins anew, so that it follows from the samples alone.
  void forget() noexcept { any_law_ = false; }

 private:
  struct Law {
    effect::SurrogateConfig declared;
    effect::SurrogateConfig found;
  };
  static bool are_alike(const Law& one, const Law& other) noexcept;
  void keep(const Sample& sample);
  void begin(const Law& law, const effect::Explanation& explanation);

  EstimatorConfig core_;
  SpscRing<Sample> ring_{kRoom};
  FrameNoise noise_;
  std::vector<Sample> kept_;  // a ring, too
  std::size_t most_kept_;
  std::size_t oldest_{0};
  Law law_{};
  bool any_law_{false};
  std::unique_ptr<Surrogates> surrogates_{std::make_unique<Surrogates>()};
};

}  // namespace dampline::app
