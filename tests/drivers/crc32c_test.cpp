// SPDX-License-Identifier: MIT
#include "drivers/checksum/crc32c.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

namespace dampline::drivers {
namespace {

/// By the definition, a bit at a time.
std::uint32_t slow_crc32c(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0x82F63B78U : 0U);
  }
  return ~crc;
}

std::vector<std::uint8_t> random_bytes(std::size_t count) {
  std::mt19937 random{7};
  std::vector<std::uint8_t> bytes(count);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

constexpr std::array<std::uint8_t, 9> kDigits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(crc32c(kDigits) == 0xE3069283U);  // the check value of the standard

TEST(Crc32c, GivesTheCheckValuesOfTheStandard) {
  EXPECT_EQ(crc32c(kDigits), 0xE3069283U);
  // RFC 3720, B.4
  EXPECT_EQ(crc32c(std::vector<std::uint8_t>(32, 0x00)), 0x8A9136AAU);
  EXPECT_EQ(crc32c(std::vector<std::uint8_t>(32, 0xFF)), 0x62A8AB43U);
  EXPECT_EQ(crc32c({}), 0U);
}

TEST(Crc32c, IsTheSameAtEveryLengthAndAlignment) {
  const auto bytes = random_bytes(80);
  for (std::size_t begin = 0; begin < 9; ++begin) {
    for (std::size_t length = 0; begin + length <= bytes.size(); ++length) {
      const auto part = std::span{bytes}.subspan(begin, length);
      ASSERT_EQ(crc32c(part), slow_crc32c(part)) << begin << " " << length;
    }
  }
}

TEST(Crc32c, GoesOnFromWhatCameBefore) {
  const auto bytes = random_bytes(50);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    const auto all = std::span{bytes};
    ASSERT_EQ(crc32c(all.subspan(cut), crc32c(all.first(cut))), crc32c(all));
  }
}

}  // namespace
}  // namespace dampline::drivers
