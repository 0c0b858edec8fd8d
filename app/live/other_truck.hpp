// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/surrogates.hpp"
#include "app/live/floor.hpp"
#include "dampline/effect/gram_store.hpp"
#include "dampline/identifier.hpp"

namespace dampline::app {

struct LiveKnown {
  const Config& config;
  const GuardedNoise& guarded;
};

/// With the floor, and without what that shows to be needless. False: there is too little yet.
[[nodiscard]] bool judge_live(const effect::Sums& sums, const LiveKnown& known, LiveFloor& floor,
                              effect::Explainer& explainer, Explained& out);

/// The truck under the other end of the body in a live run's explanation: now and then, the motion
/// that the floor keeps is explained as a file of it would be, without that truck and with it. Once
/// it is full, that is when half of it is new.
class LiveOther {
 public:
  /// Between two looks at first: each is a tenth of a second of work, 2 s where it is found.
  static constexpr double kEveryS = 20.0;

  explicit LiveOther(const IdentifierConfig& core) : core_{core} {}
  /// `out`: the run explained without it at `time_s`; with it where that leaves less, now or when
  /// it was last looked for. Returns what time of the run `out` is of.
  double look(const LiveKnown& known, const LiveFloor& kept, double time_s,
              effect::Explainer& explainer, Explained& out);
  /// The next look is a new one.
  void forget() noexcept { next_s_ = looked_s_ = 0.0; }

 private:
  std::optional<Explained> find(const LiveKnown& known, const std::vector<Sample>& samples,
                                effect::Explainer& explainer, const Explained& run) const;

  IdentifierConfig core_;
  double looked_s_{0.0};
  double next_s_{0.0};
  std::optional<Explained> with_;  // as it was last found
};

}  // namespace dampline::app
