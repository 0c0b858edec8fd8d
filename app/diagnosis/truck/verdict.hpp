// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <functional>
#include <optional>

#include "app/config/config.hpp"
#include "app/diagnosis/truck/explain.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {

inline constexpr double kBelowFloor = 0.85;  ///< times the floor: less than sensors leave

/// What the base model holds and which effects may be added to it.
[[nodiscard]] effect::ExplainerConfig explainer_config(const Config& config);
/// The same without the effects that the record's faults look like and those that are needless.
[[nodiscard]] effect::ExplainerConfig explainer_config(const Config& config,
                                                       const Explained& known);

/// Explains the sums of a record under its circumstances. False: the record is too short.
[[nodiscard]] bool judge_sums(const Config& config, const effect::Diagnosis& diagnosis,
                              effect::Explainer& explainer, Explained& out);

/// An effect that was added and is none: a channel late by less than twice what its lateness may be
/// wrong by, a stop or a friction with memory below nothing, or a later or faint one beside a model
/// that left less without it than sensors and rounding do. Its step, or step_count where each is
/// needed.
[[nodiscard]] std::size_t needless_step(const effect::Explanation& explanation) noexcept;
/// Adds it to those that are known. False where there is none.
[[nodiscard]] bool take_needless(const effect::Explanation& explanation, Needless& known) noexcept;

/// The step holds a channel that is late.
[[nodiscard]] bool is_late(const effect::Step& step) noexcept;
[[nodiscard]] bool any_of_steps(const effect::Explanation& explanation,
                                bool (*is)(const effect::Step&)) noexcept;

/// In s, by channels; 0 where no step says so.
using LateEstimates = std::array<Estimate, kChannels>;
[[nodiscard]] LateEstimates late_of(const effect::Explanation& explanation) noexcept;
/// By how much the frame is later than both wheelsets, where nothing else was found but friction
/// that builds up.
[[nodiscard]] std::optional<double> frame_late_s(const effect::Explanation& explanation) noexcept;

/// One fault more, beside which no effect is named.
void name_and_withhold(FaultKind kind, FaultChannel channel, double size, Explained& out) noexcept;

/// Takes back faults that something else explains.
void excuse(Explained& out, const std::function<bool(const Fault&)>& is_excused);
/// A wrong sample rate that was told by the wheelsets' delay, where they are late by as much.
void excuse_rate(const Config& config, const LateEstimates& late_s, Explained& out);

/// Takes back what was named without being it, once the floor is known. Where the motion says that
/// the sensors do not tell that of this truck, and the model leaves much too or takes it for a
/// wheelset's gain, that joins the faults. Where effects take hardly any of what stands over the
/// floor and it still does, they only resemble what is missing.
void hold_back(Explained& out) noexcept;

/// What the final model leaves, held out: also where it has a parameter that changes.
[[nodiscard]] double left_nmse(const Explained& explained) noexcept;
/// The same over the floor; 0 where that is unknown.
[[nodiscard]] double left_over_floor(const Explained& explained) noexcept;
[[nodiscard]] effect::Conclusion conclusion_of(const Explained& explained) noexcept;

}  // namespace dampline::app
