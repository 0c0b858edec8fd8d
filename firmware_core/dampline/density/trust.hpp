// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Why a method cannot be trusted on a record, found in the record itself.
enum class Reason : std::uint8_t {
  kNoMotion,         ///< rms velocity, m/s; at least the limit
  kConstantChannel,  ///< the smaller rms change of frame and input, m/s^2; at least the limit
  kShortRecord,      ///< time in motion, s; at least the limit
  kNarrowMotion,     ///< curve segments with samples on both sides; at least the limit
  kRangeClips,       ///< share of the mass outside the histograms; at most the limit
  kColouredInput,    ///< scatter of the input's spectrum over its lines, dB; at most the limit
  kDependence,       ///< of y and v, sqrt(chi^2 / N) above chance; at most the limit
  kNonStationary,    ///< largest |ln| of a quarter's power over the mean, above chance
  kBentCurve,        ///< 1 - force of slow motion over that of fast motion; at most the limit
  kNotSolvable,      ///< equations without a solution; 1 is a violation
};
inline constexpr std::size_t kReasons = 10;

/// In words that end a sentence: "not trusted: ...".
[[nodiscard]] const char* text(Reason reason) noexcept;
/// Unit of the size: "m/s", "dB", ..., "" for pure numbers.
[[nodiscard]] const char* unit(Reason reason) noexcept;

struct Finding {
  bool checked{false};  ///< the method depends on it, and there was enough to tell
  bool violated{false};
  double size{0.0};
  double limit{0.0};
};

struct TrustVerdict {
  bool has_number{false};  ///< false: what the method gave means nothing and is not given
  bool trusted{false};     ///< has a number and nothing is violated
  std::array<Finding, kReasons> findings{};

  [[nodiscard]] const Finding& operator[](Reason reason) const noexcept {
    return findings[static_cast<std::size_t>(reason)];
  }
  /// `size` must be at least / at most `limit`.
  void require_at_least(Reason reason, double size, double limit) noexcept;
  void require_at_most(Reason reason, double size, double limit) noexcept;
  [[nodiscard]] bool violates(Reason reason) const noexcept { return (*this)[reason].violated; }
  /// The first violation in the order of Reason; false when there is none.
  [[nodiscard]] bool first_violation(Reason& reason) const noexcept;
};

}  // namespace dampline
