// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/guard/guard.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// Samples wait here until the guards have judged them, on their way to the Estimator. Single
/// wrong samples are replaced by what their neighbours say,
/// x0 = (-x_-2 + 4 x_-1 + 4 x_+1 - x_+2) / 6; where a fault lasts for some seconds only (a jump of
/// the zero, a burst of noise, samples that were lost or repeated and not counted), samples come
/// out as spoilt. Lasting faults spoil nothing here: nothing would be left. One sample out for each
/// one in, so a call costs a bounded number of operations, gap or not.
class JudgementDelay {
 public:
  static constexpr std::size_t kMost = 10000;  ///< samples that can wait

  /// `samples`: how many wait, at most kMost; 0 passes all on as they are.
  explicit JudgementDelay(std::size_t samples) noexcept
      : wait_{samples < kMost ? samples : kMost} {}

  /// Takes what the guard has just seen. True when it wrote the sample that has waited long enough.
  bool push(const Sample& sample, Guard& guard, Sample& out) noexcept;
  /// End of the record: the samples that still wait, one per call.
  bool drain(Guard& guard, Sample& out) noexcept;
  [[nodiscard]] const RepairCounts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t kRing = kMost + 4;
  struct Held {
    Sample sample{};
    std::uint8_t wrong{0};  // bit c: channel c
    [[nodiscard]] bool is_wrong(std::size_t channel) const noexcept {
      return (std::uint32_t{wrong} >> channel & 1U) != 0;
    }
  };
  [[nodiscard]] Held& held(std::size_t age) noexcept {
    return ring_[(newest_ + kRing - age) % kRing];
  }
  void mark(const WrongSample& wrong) noexcept;
  void mark_all(Guard& guard) noexcept;
  void take_oldest(const Guard& guard, Sample& out) noexcept;
  [[nodiscard]] bool replace(std::size_t age, std::size_t channel) noexcept;

  std::size_t wait_;
  std::array<Held, kRing> ring_{};
  std::size_t newest_{0};  // slot of the newest
  std::size_t count_{0};   // that wait
  std::size_t gone_{0};    // that came out and are still known, at most two
  RepairCounts counts_{};
};

}  // namespace dampline
