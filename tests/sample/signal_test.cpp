// SPDX-License-Identifier: MIT
#include "dampline/sample/signal.hpp"

#include <gtest/gtest.h>

#include <random>

#include "dampline/sample/channel.hpp"

namespace dampline {
namespace {

/// The bit with a number of the DBC convention: bit b lies in byte b / 8 at 2^(b % 8).
bool dbc_bit(const CanFrame& frame, int number) {
  return (frame.data[static_cast<std::size_t>(number / 8)] >> (number % 8) & 1) != 0;
}

/// Walks the signal bit by bit, as the convention is written down; nothing in common with
/// extract_bits.
std::uint64_t bit_by_bit(const SignalLayout& signal, const CanFrame& frame) {
  std::uint64_t value = 0;
  if (signal.order == ByteOrder::kIntel) {
    for (int i = signal.length - 1; i >= 0; --i) {
      value = value * 2 + (dbc_bit(frame, signal.start_bit + i) ? 1 : 0);
    }
    return value;
  }
  int number = signal.start_bit;
  for (int i = 0; i < signal.length; ++i) {
    value = value * 2 + (dbc_bit(frame, number) ? 1 : 0);
    number = number % 8 == 0 ? number + 15 : number - 1;  // the sawtooth
  }
  return value;
}

CanFrame random_frame(std::mt19937_64& random, std::uint8_t length) {
  CanFrame frame;
  frame.length = length;
  for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
  return frame;
}

SignalLayout layout(int start, int length, ByteOrder order, bool is_signed = false) {
  SignalLayout signal;
  signal.start_bit = static_cast<std::uint16_t>(start);
  signal.length = static_cast<std::uint8_t>(length);
  signal.order = order;
  signal.is_signed = is_signed;
  return signal;
}

/// True when the walk stays inside `bytes` bytes.
bool inside(const SignalLayout& signal, int bytes) {
  if (signal.order == ByteOrder::kIntel) return signal.start_bit + signal.length <= 8 * bytes;
  int number = signal.start_bit;
  for (int i = 1; i < signal.length; ++i) number = number % 8 == 0 ? number + 15 : number - 1;
  return number < 8 * bytes;
}

TEST(Extract, AgreesWithTheBitByBitWalkForEveryStartLengthAndOrder) {
  std::mt19937_64 random{1};
  for (const std::uint8_t bytes : {std::uint8_t{8}, std::uint8_t{16}}) {
    for (int start = 0; start < 8 * bytes; ++start) {
      for (int length = 1; length <= 64; ++length) {
        for (const ByteOrder order : {ByteOrder::kIntel, ByteOrder::kMotorola}) {
          const CanFrame frame = random_frame(random, bytes);
          const SignalLayout signal = layout(start, length, order);
          const auto bits = extract_bits(signal, frame);
          ASSERT_EQ(bits.ok(), inside(signal, bytes)) << start << '|' << length;
          if (!bits.ok()) continue;
          ASSERT_EQ(bits.value(), bit_by_bit(signal, frame)) << start << '|' << length;
        }
      }
    }
  }
}

TEST(Extract, SignExtendsEveryLength) {
  std::mt19937_64 random{2};
  for (int length = 1; length <= 64; ++length) {
    const CanFrame frame = random_frame(random, 16);
    const std::uint64_t bits = extract_bits(layout(5, length, ByteOrder::kIntel), frame).value();
    const std::int64_t raw = extract_raw(layout(5, length, ByteOrder::kIntel, true), frame).value();
    const bool negative = (bits >> (length - 1) & 1U) != 0;
    // Two's complement by its definition: value - 2^length where the top bit is set.
    const std::uint64_t modulus = length == 64 ? 0 : std::uint64_t{1} << length;
    EXPECT_EQ(static_cast<std::uint64_t>(raw), negative ? bits - modulus : bits) << length;
    EXPECT_EQ(raw < 0, negative);
  }
}

TEST(Extract, ReadsVectorsComputedByHand) {
  CanFrame frame;
  frame.length = 8;
  frame.data = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
  EXPECT_EQ(extract_raw(layout(0, 16, ByteOrder::kIntel), frame).value(), 0x3412);
  EXPECT_EQ(extract_raw(layout(4, 12, ByteOrder::kIntel), frame).value(), 0x341);
  EXPECT_EQ(extract_raw(layout(7, 16, ByteOrder::kMotorola), frame).value(), 0x1234);
  EXPECT_EQ(extract_raw(layout(3, 12, ByteOrder::kMotorola), frame).value(), 0x234);
  EXPECT_EQ(extract_raw(layout(7, 12, ByteOrder::kMotorola), frame).value(), 0x123);
  EXPECT_EQ(extract_raw(layout(56, 8, ByteOrder::kIntel, true), frame).value(), -16);
  EXPECT_EQ(extract_raw(layout(39, 12, ByteOrder::kMotorola, true), frame).value(), 0x9AB - 0x1000);
}

// Vector's figure: start bits of a Motorola signal run 7 6 5 4 3 2 1 0 | 15 14 ... 8 | 23 ...
TEST(Extract, FollowsTheMotorolaSawtooth) {
  CanFrame frame;
  frame.length = 8;
  frame.data = {0b0000'0001, 0b1000'0000};  // bit 0 and bit 15 are neighbours
  EXPECT_EQ(extract_raw(layout(0, 2, ByteOrder::kMotorola), frame).value(), 3);
  EXPECT_EQ(extract_raw(layout(1, 4, ByteOrder::kMotorola), frame).value(), 0b0110);
  EXPECT_EQ(extract_raw(layout(15, 1, ByteOrder::kMotorola), frame).value(), 1);
  EXPECT_EQ(bytes_needed(layout(0, 2, ByteOrder::kMotorola)), 2);
  EXPECT_EQ(bytes_needed(layout(7, 8, ByteOrder::kMotorola)), 1);
}

TEST(Extract, SaysThatAFrameIsTooShort) {
  CanFrame frame;
  frame.length = 2;
  EXPECT_TRUE(extract_raw(layout(4, 12, ByteOrder::kIntel), frame).ok());
  EXPECT_EQ(extract_raw(layout(5, 12, ByteOrder::kIntel), frame).error(), Errc::kMalformed);
  EXPECT_EQ(extract_physical(layout(2, 12, ByteOrder::kMotorola), frame).error(), Errc::kMalformed);
}

TEST(Extract, ScalesAndOffsets) {
  CanFrame frame;
  frame.length = 8;
  frame.data = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
  SignalLayout signal = layout(0, 12, ByteOrder::kIntel, true);
  signal.scale = 0.05;
  signal.offset = 1.0;
  EXPECT_DOUBLE_EQ(extract_physical(signal, frame).value(), 0.95);
  EXPECT_DOUBLE_EQ(extract_physical(layout(0, 64, ByteOrder::kIntel), frame).value(),
                   18446744073709551615.0);
  EXPECT_EQ(extract_raw(layout(0, 64, ByteOrder::kIntel), frame).value(), -1) << "it wraps";
}

TEST(Extract, RefusesLayoutsThatCannotBe) {
  EXPECT_FALSE(is_valid(layout(0, 0, ByteOrder::kIntel)));
  EXPECT_FALSE(is_valid(layout(0, 65, ByteOrder::kIntel)));
  EXPECT_FALSE(is_valid(layout(511, 2, ByteOrder::kIntel)));
  EXPECT_TRUE(is_valid(layout(511, 1, ByteOrder::kIntel)));
  EXPECT_FALSE(is_valid(layout(504, 2, ByteOrder::kMotorola)));
  SignalLayout no_scale = layout(0, 8, ByteOrder::kIntel);
  no_scale.scale = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(no_scale));
}

TEST(FullScaleCodes, AreTheEndsOfTheBitLength) {
  const FullScale twelve = full_scale_of(layout(0, 12, ByteOrder::kIntel, true));
  EXPECT_TRUE(twelve.reached(2047));
  EXPECT_TRUE(twelve.reached(-2048));
  EXPECT_FALSE(twelve.reached(2046));
  EXPECT_FALSE(twelve.reached(-2047));
  const FullScale counts = full_scale_of(layout(0, 12, ByteOrder::kIntel));
  EXPECT_TRUE(counts.reached(0));
  EXPECT_TRUE(counts.reached(4095));
  EXPECT_FALSE(counts.reached(1));
}

TEST(FullScaleCodes, FollowTheStatedRangeWhereItIsNarrower) {
  SignalLayout signal = layout(0, 8, ByteOrder::kIntel, true);
  signal.scale =
      0.2;  // ACCEL_LAT of the measured log: [-25.4|25.4], 127 * 0.2 rounds to above 25.4
  signal.minimum = -25.4;
  signal.maximum = 25.4;
  EXPECT_TRUE(full_scale_of(signal).reached(127));
  EXPECT_TRUE(full_scale_of(signal).reached(-127));
  EXPECT_FALSE(full_scale_of(signal).reached(126));
  signal.scale = -0.2;  // mounted upside down
  signal.minimum = -20.0;
  EXPECT_TRUE(full_scale_of(signal).reached(100));
  EXPECT_FALSE(full_scale_of(signal).reached(99));
  EXPECT_TRUE(full_scale_of(signal).reached(-127));
}

}  // namespace
}  // namespace dampline
