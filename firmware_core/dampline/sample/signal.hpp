// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>

#include "dampline/can_frame.hpp"
#include "dampline/result.hpp"

namespace dampline {

enum class ByteOrder : std::uint8_t { kIntel, kMotorola };

/// Where a signal lies in a frame, in the terms of a DBC file:
/// SG_ NAME : start_bit|length@order sign (scale,offset) [minimum|maximum] "unit".
struct SignalLayout {
  std::uint16_t start_bit{0};  ///< Intel: least significant bit; Motorola: most significant bit
  std::uint8_t length{0};      ///< bits, 1...64
  ByteOrder order{ByteOrder::kIntel};
  bool is_signed{false};
  double scale{1.0};
  double offset{0.0};
  double minimum{0.0};  ///< physical; minimum == maximum means "not stated"
  double maximum{0.0};
};

/// The bytes that a signal touches, from the one that holds its least significant bit on.
struct SignalBytes {
  int first{0};       ///< byte with the least significant bit
  int count{0};       ///< bytes touched, 1...9
  int step{1};        ///< +1 Intel, -1 Motorola: where the next more significant byte lies
  unsigned shift{0};  ///< bit of the first byte at which the signal begins
};

/// Numbering of a DBC file: bit b lies in byte b / 8 at 2^(b % 8), in both byte orders. An Intel
/// signal grows from its start bit to higher numbers; a Motorola signal falls from its start bit to
/// the right end of the byte and goes on at the left end (bit 7) of the next ("sawtooth").
[[nodiscard]] constexpr SignalBytes bytes_of(const SignalLayout& signal) noexcept {
  if (signal.order == ByteOrder::kIntel) {
    const int last_bit = signal.start_bit + signal.length - 1;
    const int first = signal.start_bit / 8;
    return {first, last_bit / 8 - first + 1, 1, static_cast<unsigned>(signal.start_bit % 8)};
  }
  const int first_reading_bit = signal.start_bit / 8 * 8 + (7 - signal.start_bit % 8);
  const int last_reading_bit = first_reading_bit + signal.length - 1;
  const int last_byte = last_reading_bit / 8;
  return {last_byte, last_byte - signal.start_bit / 8 + 1, -1,
          static_cast<unsigned>(7 - last_reading_bit % 8)};
}

/// Payload bytes that a frame must have for the signal to lie inside it.
[[nodiscard]] constexpr int bytes_needed(const SignalLayout& signal) noexcept {
  const SignalBytes bytes = bytes_of(signal);
  return signal.order == ByteOrder::kIntel ? bytes.first + bytes.count : bytes.first + 1;
}

/// Length 1...64 bits, inside a frame of 64 bytes, and a scale that is a number and not zero.
[[nodiscard]] constexpr bool is_valid(const SignalLayout& signal) noexcept {
  if (signal.length < 1 || signal.length > 64 || signal.start_bit >= 512) return false;
  if (!(signal.scale > 0.0 || signal.scale < 0.0)) return false;
  return bytes_needed(signal) <= 64;
}

/// Eight bytes from `first` on as one number, the first byte the least significant; written so that
/// compilers make one load of it.
[[nodiscard]] constexpr std::uint64_t intel_word(const std::uint8_t* first) noexcept {
  const auto byte = [first](int i) { return std::uint64_t{first[i]}; };
  return byte(0) | byte(1) << 8U | byte(2) << 16U | byte(3) << 24U | byte(4) << 32U |
         byte(5) << 40U | byte(6) << 48U | byte(7) << 56U;
}

/// The first byte the most significant.
[[nodiscard]] constexpr std::uint64_t motorola_word(const std::uint8_t* first) noexcept {
  const auto byte = [first](int i) { return std::uint64_t{first[i]}; };
  return byte(0) << 56U | byte(1) << 48U | byte(2) << 40U | byte(3) << 32U | byte(4) << 24U |
         byte(5) << 16U | byte(6) << 8U | byte(7);
}

/// Bits of a signal byte by byte; a signal of 64 bits may touch nine.
[[nodiscard]] constexpr std::uint64_t gather_bits(const SignalLayout& signal,
                                                  const CanFrame& frame) noexcept {
  const SignalBytes bytes = bytes_of(signal);
  const auto byte = [&](int i) -> std::uint64_t {
    const int index = bytes.first + i * bytes.step;
    return frame.data[static_cast<std::size_t>(index)];
  };
  std::uint64_t bits = byte(0) >> bytes.shift;
  for (int i = 1; i < bytes.count; ++i)
    bits |= byte(i) << (8U * static_cast<unsigned>(i) - bytes.shift);
  return bits;
}

/// physical = raw * scale + offset, as a DBC file defines it.
[[nodiscard]] constexpr double to_physical(const SignalLayout& signal, std::int64_t raw) noexcept {
  const bool wraps = !signal.is_signed && signal.length == 64;
  const double number =
      wraps ? static_cast<double>(static_cast<std::uint64_t>(raw)) : static_cast<double>(raw);
  return number * signal.scale + signal.offset;
}

/// Reads one signal of many frames: what follows from the layout is worked out once.
class SignalReader {
 public:
  /// Precondition: is_valid(signal), or a length of 0 (a record without frames), which reads
  /// nothing.
  explicit constexpr SignalReader(const SignalLayout& signal) noexcept
      : signal_{signal},
        needed_{bytes_needed(signal)},
        first_{signal.start_bit / 8U},
        unused_{signal.length > 0 ? 64U - signal.length : 0U},
        used_{signal.is_signed ? ~std::uint64_t{0} : ~std::uint64_t{0} >> unused_} {
    const unsigned bit = signal.start_bit % 8U;
    const bool intel = signal.order == ByteOrder::kIntel;
    const unsigned before = intel ? bit : 7U - bit;
    is_word_ = before <= unused_ && first_ + 8U <= CanFrame{}.data.size();
    if (is_word_) left_ = intel ? unused_ - before : before;
  }

  /// The frame is long enough.
  [[nodiscard]] constexpr bool fits(const CanFrame& frame) const noexcept {
    return needed_ <= frame.length;
  }
  /// Right-aligned. Precondition: fits(frame).
  [[nodiscard]] constexpr std::uint64_t bits(const CanFrame& frame) const noexcept {
    return top(frame) >> unused_;
  }
  /// Sign-extended where the signal is signed. An unsigned number of 64 bits wraps.
  /// Precondition: fits(frame).
  [[nodiscard]] constexpr std::int64_t raw(const CanFrame& frame) const noexcept {
    const std::int64_t extended = static_cast<std::int64_t>(top(frame)) >> unused_;
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(extended) & used_);
  }
  [[nodiscard]] constexpr double physical(std::int64_t raw) const noexcept {
    return to_physical(signal_, raw);
  }

 private:
  /// The signal's bits at the top of a word.
  [[nodiscard]] constexpr std::uint64_t top(const CanFrame& frame) const noexcept {
    if (!is_word_) return gather_bits(signal_, frame) << unused_;
    const std::uint8_t* const bytes = frame.data.data() + first_;
    return (signal_.order == ByteOrder::kIntel ? intel_word(bytes) : motorola_word(bytes)) << left_;
  }

  SignalLayout signal_;
  int needed_;
  unsigned first_;
  unsigned unused_;
  std::uint64_t used_;  // bits of the number; all where the sign is extended
  unsigned left_{0};
  bool is_word_{false};  // eight bytes in a row hold it whole
};

/// The signal's bits, right-aligned. kMalformed when the frame is too short for it.
/// Precondition: is_valid(signal). At most nine steps.
[[nodiscard]] constexpr Result<std::uint64_t> extract_bits(const SignalLayout& signal,
                                                           const CanFrame& frame) noexcept {
  const SignalReader reader{signal};
  if (!reader.fits(frame)) return Errc::kMalformed;
  return reader.bits(frame);
}

/// The raw number, sign-extended where the signal is signed. An unsigned number of 64 bits wraps.
[[nodiscard]] constexpr Result<std::int64_t> extract_raw(const SignalLayout& signal,
                                                         const CanFrame& frame) noexcept {
  const SignalReader reader{signal};
  if (!reader.fits(frame)) return Errc::kMalformed;
  return reader.raw(frame);
}

/// The signal's physical value. kMalformed when the frame is too short for it.
[[nodiscard]] constexpr Result<double> extract_physical(const SignalLayout& signal,
                                                        const CanFrame& frame) noexcept {
  const Result<std::int64_t> raw = extract_raw(signal, frame);
  if (!raw.ok()) return raw.error();
  return to_physical(signal, raw.value());
}

}  // namespace dampline
