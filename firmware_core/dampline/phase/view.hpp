// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/density/joint_histogram.hpp"
#include "dampline/motion/motion.hpp"
#include "dampline/phase/period.hpp"
#include "dampline/phase/stroboscope.hpp"
#include "dampline/result.hpp"

namespace dampline {

inline constexpr std::size_t kPictureCells = 96;

/// What a picture is worth.
enum class PictureState : std::uint8_t {
  kEmpty,     ///< no sample
  kConstant,  ///< all samples in one row, column or cell: a channel that does not vary
  kClipped,   ///< more than 1 % of the samples lie outside the range: the picture lacks them
  kGood
};

/// Probability density over one plane of the phase space.
struct PhasePicture {
  PictureState state{PictureState::kEmpty};
  double x_low{0.0}, x_high{0.0};  ///< range of the first axis, in its unit
  double y_low{0.0}, y_high{0.0};
  std::uint64_t samples{0};
  double outside_share{0.0};  ///< of the samples; 0 ... 1
  /// Per unit of x and of y; [i][j], i along x from its low end, j along y.
  std::array<std::array<float, kPictureCells>, kPictureCells> density{};
};

using PictureHistogram = JointHistogram<kPictureCells, kPictureCells>;

/// A pass over all cells: not for the sample path.
void make_picture(const PictureHistogram& histogram, PhasePicture& out) noexcept;

inline constexpr std::size_t kSectionPhases = 4;
inline constexpr std::size_t kSectionPoints = 200;

struct PhaseViewConfig {
  double sample_rate_hz{300.0};
  /// Ranges of the pictures; low = high: learned during `learn_s`.
  double deflection_low_m{0.0}, deflection_high_m{0.0};
  double velocity_low_mps{0.0}, velocity_high_mps{0.0};
  double accel_low_mps2{0.0}, accel_high_mps2{0.0};
  double learn_s{60.0};
  /// A known period, as of a shaker; 0: detected from the velocity, 0.1 ... 2.5 s.
  double known_period_s{0.0};
};

/// The extended phase space at one moment, as plain numbers to draw.
struct PhaseSnapshot {
  PhasePicture velocity_over_deflection;  ///< x = y in m, y = v in m/s
  PhasePicture accel_over_deflection;     ///< x = y in m, y = y'' in m/s^2
  PhasePicture accel_over_velocity;       ///< x = v in m/s, y = y'' in m/s^2
  std::uint64_t still{0};                 ///< samples left out: the truck stood
  std::uint64_t not_finite{0};            ///< samples left out
  bool period_is_known{false};            ///< given, not detected
  Period period;
  /// The newest points of each phase, oldest first. None where the motion has no period, or not the
  /// one that it is said to have.
  std::array<std::array<PhasePoint, kSectionPoints>, kSectionPhases> section{};
  std::array<std::size_t, kSectionPhases> section_count{};
};

/// Density pictures of the three planes of (y, y', y''), and stroboscopic sections at four phases
/// of a period that is known or detected. Takes what an Estimator gives out. Fixed size, no heap;
/// every ten seconds of samples, one call looks for the period, which takes some ten microseconds.
class PhaseView {
 public:
  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<PhaseViewConfig> check(const PhaseViewConfig& config) noexcept;

  /// Precondition: check(config).ok().
  explicit PhaseView(const PhaseViewConfig& config) noexcept;

  void update(const Motion& motion) noexcept;

  /// A pass over all cells. `out` is some 130 KiB: place it yourself.
  void snapshot(PhaseSnapshot& out) const noexcept;

 private:
  using Meter = PeriodMeter<512>;
  struct Ring {
    std::array<PhasePoint, kSectionPoints> points{};
    std::uint64_t count{0};
  };

  void look_for_period() noexcept;
  void start_sections(double period_s) noexcept;
  void stop_sections() noexcept;

  PhaseViewConfig config_;
  double step_s_;
  PictureHistogram velocity_over_deflection_;
  PictureHistogram accel_over_deflection_;
  PictureHistogram accel_over_velocity_;
  Meter meter_;
  bool strobes_{false};
  Stroboscope stroboscope_;
  double strobed_since_s_{0.0};
  std::array<Ring, kSectionPhases> rings_{};
  bool has_last_{false};
  std::int64_t last_tick_{0};
  std::uint64_t until_look_;
  std::uint64_t still_{0};
  std::uint64_t not_finite_{0};
};

}  // namespace dampline
