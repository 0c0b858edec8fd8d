// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dampline::drivers {

namespace detail {
using Crc32cTables = std::array<std::array<std::uint32_t, 256>, 8>;

/// [0] is the table of one byte; [k] that of a byte with k zero bytes behind it.
constexpr Crc32cTables make_crc32c_tables() noexcept {
  Crc32cTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0x82F63B78U : 0U);
    tables[0][i] = crc;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t i = 0; i < 256; ++i) {
      const std::uint32_t shorter = tables[k - 1][i];
      tables[k][i] = (shorter >> 8U) ^ tables[0][shorter & 0xFFU];
    }
  }
  return tables;
}
inline constexpr Crc32cTables kCrc32cTables = make_crc32c_tables();

constexpr std::uint32_t little_endian_word(const std::uint8_t* at) noexcept {
  return static_cast<std::uint32_t>(at[0]) | static_cast<std::uint32_t>(at[1]) << 8U |
         static_cast<std::uint32_t>(at[2]) << 16U | static_cast<std::uint32_t>(at[3]) << 24U;
}
}  // namespace detail

/// CRC-32C (Castagnoli, reflected, polynomial 0x1EDC6F41) as in RFC 3720; of "123456789":
/// 0xE3069283. With the checksum of what came before, that of both together. Eight bytes a step
/// ("slicing by 8").
[[nodiscard]] constexpr std::uint32_t crc32c(std::span<const std::uint8_t> bytes,
                                             std::uint32_t before = 0) noexcept {
  const auto& table = detail::kCrc32cTables;
  std::uint32_t crc = ~before;
  const std::uint8_t* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, at += 8) {
    const std::uint32_t low = crc ^ detail::little_endian_word(at);
    const std::uint32_t high = detail::little_endian_word(at + 4);
    crc = table[7][low & 0xFFU] ^ table[6][low >> 8U & 0xFFU] ^ table[5][low >> 16U & 0xFFU] ^
          table[4][low >> 24U] ^ table[3][high & 0xFFU] ^ table[2][high >> 8U & 0xFFU] ^
          table[1][high >> 16U & 0xFFU] ^ table[0][high >> 24U];
  }
  for (; left > 0; --left, ++at) crc = (crc >> 8U) ^ table[0][(crc ^ *at) & 0xFFU];
  return ~crc;
}

}  // namespace dampline::drivers
