// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/law_profile.hpp"
#include "dampline/estimate/statistics.hpp"
#include "dampline/faults.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Whether a parameter changed while the record was made (`time_drift`), which, when, how much.
struct ParameterDrift {
  bool judged{false};  ///< there are enough entries to say anything
  bool found{false};
  DriftingParameter parameter{};
  bool step{false};                    ///< at once; else slowly over the whole record
  double time_s{0.0};                  ///< of the step, in moving time from the oldest entry on
  double interval_s{0.0};              ///< the step lies within half of it on either side of time_s
  Estimate change;                     ///< relative: 0.1 means 10 % more after it, or at the end
  double gain{0.0};                    ///< share of the held-out error that the change explains
  double friction_significance{0.0};   ///< largest step of the entries' own friction, in deviations
  double stiffness_significance{0.0};  ///< the same of their stiffness
};

/// Tests the entries of the statistics for a step between any two of them and for a trend, of
/// friction, stiffness and mass (both at once: the rows are per unit of mass). A change of
/// parameter p is one more column w_b X_b u, where u is the part of the solution that p scales and
/// w_b is 0 before a step and 1 after it, or the place in the record; its normal equations follow
/// from those of the entries, so the data are not needed again. Compared by the error of held-out
/// entries.
///
/// Some hundred small systems of equations: not for the sample path.
[[nodiscard]] ParameterDrift find_parameter_drift(const ScaleFactors& total, EntryList entries,
                                                  double entry_s) noexcept;
[[nodiscard]] ParameterDrift find_parameter_drift(const Statistics& statistics,
                                                  double block_s) noexcept;

/// What a fault does to the parameters is no change of theirs: where samples of a channel moved in
/// time, or a gain changed, none is found. A mass that seems to change while the frame moves as
/// much more with the wheelsets, or may do so, is a gain of the frame's sensor: it joins the
/// faults.
void hold_against_faults(FaultView& faults, ParameterDrift& drift) noexcept;

/// Level of friction and stiffness of the newest blocks alone, from how the sums over all blocks
/// have grown: the normal equations of a group are those of now less those of before. The law's
/// width and the weights of the scales are those of the first blocks and stay. For an infinite
/// memory only: the sums must not forget.
class GroupMeter {
 public:
  static constexpr std::uint32_t kFirstBlocks = 150;  ///< that fix the law, some 5 minutes
  static constexpr std::uint32_t kGroupBlocks = 30;   ///< a minute of motion

  struct Group {
    double friction_mps2{0.0};  ///< Fc / M
    double stiffness_ps2{0.0};  ///< k / M
  };
  /// Blocks in the sums at which update() has something to do.
  [[nodiscard]] std::uint32_t due() const noexcept { return due_; }
  /// True when it wrote a group. Some thousand operations; the first time some hundred thousand.
  bool update(const ScaleFactors& total, Group& out) noexcept;

 private:
  using Profile = LawProfile<false>;
  using Gram = Eigen::Matrix<double, Profile::kUnknowns + 1, Profile::kUnknowns + 1>;

  std::uint32_t due_{kFirstBlocks};
  bool has_law_{false};
  Profile law_{};
  Gram before_ = Gram::Zero();
};

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
