// SPDX-License-Identifier: MIT
#include "drivers/mat/whole.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/bytes/little_endian.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kHeader = 128;
constexpr std::size_t kMarkAt = 126;  // "IM" as a little-endian machine writes it
constexpr std::size_t kTag = 8;
constexpr std::uint32_t kCompressed = 15;

bool inflates(const RandomFile& file, std::uint64_t begin, std::uint64_t bytes) {
  constexpr std::size_t kPiece = std::size_t{64} * 1024;
  const auto inflate = make_zlib();
  if (!inflate) return false;
  inflate->restart();
  std::vector<char> packed(kPiece);
  std::vector<char> plain(4 * kPiece);
  while (!inflate->is_whole()) {
    const std::size_t count =
        file.read(begin, std::span{packed}.first(std::min<std::uint64_t>(kPiece, bytes)));
    if (count == 0) return false;
    begin += count;
    bytes -= count;
    for (std::span<const char> rest{packed.data(), count}; !inflate->is_whole();) {
      const auto step = inflate->push(rest, plain);
      if (step.fault != nullptr) return false;
      rest = rest.subspan(step.taken);
      if (rest.empty() && step.given < plain.size()) break;
    }
  }
  return true;
}

}  // namespace

std::string fault_of_mat(const RandomFile& file) {
  std::array<char, kHeader> header{};
  if (file.read(0, header) < kHeader) return "ends within its header";
  const bool swapped = std::string_view{&header[kMarkAt], 2} == "MI";
  const auto number = [&](const char* at) {
    const auto raw = little<std::uint32_t>(at);
    return swapped ? __builtin_bswap32(raw) : raw;
  };
  for (std::uint64_t at = kHeader; at < file.size();) {
    std::array<char, kTag> tag{};
    const bool whole = file.read(at, tag) == kTag;
    const std::uint32_t type = number(tag.data());
    const std::uint64_t bytes = (type >> 16U) != 0 ? 0 : number(tag.data() + 4);
    if (!whole || bytes > file.size() - at - kTag)
      return fmt::format("the element at byte {} is cut off", at);
    if (type == kCompressed && !inflates(file, at + kTag, bytes))
      return fmt::format("the deflated data at byte {} are damaged or cut off", at);
    at += kTag + bytes;
  }
  return {};
}

}  // namespace dampline::drivers
