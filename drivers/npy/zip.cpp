// SPDX-License-Identifier: MIT
#include "drivers/npy/zip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "drivers/bytes/little_endian.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kEnd = 22;  // the end record, without its comment
constexpr std::size_t kMostComment = 65535;
constexpr std::size_t kEntry = 46;  // of the directory, without name, extra and comment
constexpr std::size_t kLocal = 30;  // before a member's name
constexpr std::size_t kMostDirectory = std::size_t{1} << 20U;
constexpr std::size_t kMostMembers = 1024;
constexpr std::uint32_t kElsewhere = 0xFFFFFFFFU;  // in the 64-bit fields

struct Directory {
  std::uint64_t begin{0};
  std::uint64_t bytes{0};
};

std::optional<Directory> find_directory(const RandomFile& file) {
  const std::uint64_t tail = std::min<std::uint64_t>(file.size(), kEnd + kMostComment);
  std::vector<char> bytes(static_cast<std::size_t>(tail));
  if (file.read(file.size() - tail, bytes) != tail || tail < kEnd) return std::nullopt;
  const std::size_t at = std::string_view{bytes.data(), bytes.size()}.rfind("PK\x05\x06");
  if (at == std::string_view::npos || at + kEnd > bytes.size()) return std::nullopt;
  Directory out{little<std::uint32_t>(&bytes[at + 16]), little<std::uint32_t>(&bytes[at + 12])};
  if (out.begin != kElsewhere) return out;
  std::array<char, 56> wide{};
  if (at < 20 || std::string_view{&bytes[at - 20], 4} != "PK\x06\x07" ||
      file.read(little<std::uint64_t>(&bytes[at - 12]), wide) != wide.size())
    return std::nullopt;
  return Directory{little<std::uint64_t>(&wide[48]), little<std::uint64_t>(&wide[40])};
}

/// What the 64-bit extra field says instead of a size or an offset that did not fit.
void widen(std::string_view extra, std::array<std::uint64_t*, 3> fields) {
  while (extra.size() >= 4) {
    const auto kind = little<std::uint16_t>(extra.data());
    const std::size_t bytes =
        std::min<std::size_t>(little<std::uint16_t>(extra.data() + 2), extra.size() - 4);
    std::string_view content = extra.substr(4, bytes);
    extra.remove_prefix(4 + bytes);
    if (kind != 1) continue;
    for (std::uint64_t* field : fields) {
      if (*field != kElsewhere || content.size() < 8) continue;
      *field = little<std::uint64_t>(content.data());
      content.remove_prefix(8);
    }
  }
}

/// Behind the header that stands before a member's data.
std::optional<std::uint64_t> data_of(const RandomFile& file, std::uint64_t local) {
  std::array<char, kLocal> head{};
  if (file.read(local, head) != head.size() || std::string_view{head.data(), 4} != "PK\x03\x04")
    return std::nullopt;
  return local + kLocal + little<std::uint16_t>(&head[26]) + little<std::uint16_t>(&head[28]);
}

}  // namespace

Outcome<std::vector<ZipMember>> zip_members(const RandomFile& file, const std::string& name) {
  const auto damaged = [&](const char* what) {
    return Failure{Errc::kMalformed, fmt::format("{}: {}: it is cut off or damaged", name, what)};
  };
  const auto directory = find_directory(file);
  if (!directory) return damaged("found no directory of its arrays");
  std::vector<char> bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(directory->bytes, kMostDirectory)));
  bytes.resize(file.read(directory->begin, bytes));
  std::string_view rest{bytes.data(), bytes.size()};
  std::vector<ZipMember> out;
  while (rest.size() >= kEntry && rest.starts_with("PK\x01\x02") && out.size() < kMostMembers) {
    const auto method = little<std::uint16_t>(rest.data() + 10);
    std::uint64_t packed = little<std::uint32_t>(rest.data() + 20);
    std::uint64_t whole = little<std::uint32_t>(rest.data() + 24);
    std::uint64_t local = little<std::uint32_t>(rest.data() + 42);
    const std::size_t name_bytes = little<std::uint16_t>(rest.data() + 28);
    const std::size_t extra_bytes = little<std::uint16_t>(rest.data() + 30);
    const std::size_t comment_bytes = little<std::uint16_t>(rest.data() + 32);
    if (rest.size() < kEntry + name_bytes + extra_bytes + comment_bytes) break;
    widen(rest.substr(kEntry + name_bytes, extra_bytes), {&whole, &packed, &local});
    const auto begin = data_of(file, local);
    if (!begin) return damaged("found no array where its directory says");
    if (method == 0 || method == 8)
      out.push_back({std::string{rest.substr(kEntry, name_bytes)}, method == 8, *begin, packed});
    rest.remove_prefix(kEntry + name_bytes + extra_bytes + comment_bytes);
  }
  return out;
}

}  // namespace dampline::drivers
