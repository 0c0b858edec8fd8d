// SPDX-License-Identifier: MIT
#pragma once
#include <optional>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/run/result.hpp"
#include "dampline/faults.hpp"

namespace dampline::app {

inline constexpr double kLower = 0.85;     ///< times the declared: another one
inline constexpr double kUsualHz = 100.0;  ///< above, corners are hardly told apart

/// A low pass that is not as declared.
struct OtherLowPass {
  FaultChannel channel;
  double corner_hz;
  double nmse;  ///< that the base leaves behind it, held out
};

/// Where the low pass of all sensors seems to lie where it is not as declared: behind it the base
/// leaves clearly less of the record, held out, than `as_declared`, behind the declared one, and
/// `left_nmse`, which the effects found there leave, if any were. Its phase and gain are put right
/// before the estimate, so the wrong one leaves more; above 100 Hz that is hardly seen, and does
/// not matter. Reads the record one to some times more. Throws RunError.
[[nodiscard]] std::optional<OtherLowPass> other_low_pass(const Config& config,
                                                         const SourceOptions& source,
                                                         double as_declared,
                                                         std::optional<double> left_nmse);
/// The same of one wheelset's sensor, or of both. The corner is sought in the first two minutes.
[[nodiscard]] std::optional<OtherLowPass> other_low_pass_of_wheelsets(const Config& config,
                                                                      const SourceOptions& source,
                                                                      double as_declared,
                                                                      double left_nmse);

/// In what identify says of a file whose numbers it trusts: names a low pass of all sensors that is
/// not as declared, or tells by how much the frame seems late. They are trusted no more then. Reads
/// the first two minutes that can be used, some times.
void look_for_low_pass(const Config& config, const SourceOptions& source, RunResult& result);

}  // namespace dampline::app
