// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/guard/parameter_drift.hpp"

namespace dampline {

/// Thresholds of the live alarm; changes are relative.
struct ChangeAlarmConfig {
  double allowance{0.06};     ///< a change smaller than this is never an alarm
  double sigmas{4.0};         ///< nor is one within so many deviations of the groups themselves
  double threshold{0.15};     ///< what is beyond both, summed over groups
  std::uint32_t least{20};    ///< groups that are learnt from before anything is judged
  std::uint32_t learn{3600};  ///< groups that make the reference: 60 h of motion, of several days
};

/// A parameter is not what it was when the alarm learnt it.
struct ChangeAlarm {
  DriftingParameter parameter{};
  std::int64_t first_group{0};  ///< where it began, as far as the sum tells
  std::int64_t group{0};        ///< when the alarm was given
  double change{0.0};           ///< relative: -0.3 means 30 % less than before
};

/// Two-sided cumulative sums (Page, Biometrika 41, 1954) of the logarithms of friction and
/// stiffness, per unit of mass and from groups of blocks, over what they were when the watch began.
/// Mass shows as both at once. After an alarm it learns anew, so the next change is reported, too.
/// Weather moves the level of friction; the watch learns how much during its first days.
class ChangeWatch {
 public:
  explicit ChangeWatch(const ChangeAlarmConfig& config = {}) noexcept : config_{config} {}

  /// Level and stiffness of the next group; both positive, else the group is passed over. True when
  /// it gave an alarm.
  bool update(double friction, double stiffness, ChangeAlarm& out) noexcept;
  /// Groups so far.
  [[nodiscard]] std::int64_t groups() const noexcept { return groups_; }
  /// Of the groups that were learnt, relative: of friction and of stiffness.
  [[nodiscard]] double deviation(std::size_t which) const noexcept;

 private:
  static constexpr std::size_t kKept = 64;
  struct Track {
    double mean{0.0};
    double squares{0.0};
    double up{0.0};
    double down{0.0};
    std::int64_t up_first{0};  // group at which the sum left zero
    std::int64_t down_first{0};
  };
  using Pair = std::array<double, 2>;

  [[nodiscard]] bool judge(std::size_t which, double off, std::int64_t& first) noexcept;
  void learn(const Pair& value) noexcept;
  [[nodiscard]] double mean_since(std::size_t which, std::int64_t first) const noexcept;
  [[nodiscard]] ChangeAlarm alarm(std::size_t which, std::int64_t first) const noexcept;

  ChangeAlarmConfig config_;
  std::array<Track, 2> tracks_{};
  std::uint32_t learnt_{0};
  std::int64_t groups_{0};
  std::array<Pair, kKept> newest_{};  // off the reference
};

}  // namespace dampline
