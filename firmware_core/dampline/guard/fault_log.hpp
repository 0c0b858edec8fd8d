// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "dampline/faults.hpp"

namespace dampline {

/// The faults of a stream: one entry for each kind and channel, and which seconds are spoilt.
class FaultLog {
 public:
  static constexpr std::int64_t kSeconds = 4096;  ///< how far back spoilt seconds are known

  static constexpr std::uint32_t kGapBit = 1U << kFaultKinds;  ///< see spoil_by_gap()

  explicit FaultLog(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {}

  /// One more event. Sizes of lost and repeated samples add, of the others the largest stays.
  void report(FaultKind kind, FaultChannel channel, double time_s, double size,
              std::uint64_t events = 1) noexcept;
  /// The samples of these ticks are not what the car did; both ends included.
  void spoil(FaultKind kind, FaultChannel channel, std::int64_t first_tick,
             std::int64_t last_tick) noexcept;
  /// Samples between these ticks are missing, which their ticks show: kGapBit beside kLostSamples.
  void spoil_by_gap(std::int64_t first_tick, std::int64_t last_tick) noexcept;
  /// Bit k set: fault kind k spoils a second that holds one of these ticks.
  [[nodiscard]] std::uint32_t spoilt(std::int64_t first_tick,
                                     std::int64_t last_tick) const noexcept;
  /// Whether this fault of this channel spoils the second of a tick.
  [[nodiscard]] bool spoilt(FaultKind kind, FaultChannel channel, std::int64_t tick) const noexcept;

  [[nodiscard]] std::span<const Fault> faults() const noexcept { return {faults_.data(), size_}; }
  [[nodiscard]] const Fault* find(FaultKind kind, FaultChannel channel) const noexcept;
  [[nodiscard]] bool has(FaultKind kind) const noexcept;
  [[nodiscard]] double seconds(std::int64_t tick) const noexcept {
    return static_cast<double>(tick) / rate_hz_;
  }

 private:
  struct Second {
    std::int64_t number{-1};
    std::array<std::uint16_t, kFaultChannels> kinds{};  // bit k: fault kind k
    bool gap{false};
  };
  /// Of those that spoil seconds: from identical channels on they spoil the whole record.
  static_assert(static_cast<std::size_t>(FaultKind::kIdenticalChannels) == 16);
  /// Calls for each second from the first tick's to the last one's.
  template <typename Change>
  void change(std::int64_t first_tick, std::int64_t last_tick, Change what) noexcept;
  [[nodiscard]] std::int64_t second_of(std::int64_t tick) const noexcept {
    return static_cast<std::int64_t>(static_cast<double>(tick) / rate_hz_);
  }
  [[nodiscard]] static std::size_t slot(std::int64_t second) noexcept {
    return static_cast<std::size_t>(second) % static_cast<std::size_t>(kSeconds);
  }

  double rate_hz_;
  std::array<Fault, kMostFaults> faults_{};
  std::size_t size_{0};
  std::array<Second, kSeconds> spoilt_{};
};

}  // namespace dampline
