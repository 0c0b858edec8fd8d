// SPDX-License-Identifier: MIT
#include "drivers/blackbox/file_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <span>

#include "drivers/blackbox/format.hpp"

namespace dampline::drivers {
namespace {

constexpr std::string_view kPrefix = "blackbox-";
constexpr std::string_view kSuffix = ".dbb";
constexpr std::size_t kDigits = 6;

bool has_header(const std::filesystem::path& file) {
  std::array<char, kRecordsAt> bytes{};
  std::ifstream{file, std::ios::binary}.read(bytes.data(), bytes.size());
  const std::span<const std::uint8_t, kRecordsAt> head{
      reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  BlackboxHeader header;
  return decode_header(head.first<kHeaderBytes>(), header) != HeaderFault::kNoHeader ||
         decode_header(head.subspan<kSecondHeaderAt, kHeaderBytes>(), header) !=
             HeaderFault::kNoHeader;
}

}  // namespace

std::string blackbox_file_name(std::uint32_t number) {
  return fmt::format("{}{:06}{}", kPrefix, number, kSuffix);
}

std::optional<std::uint32_t> blackbox_file_number(std::string_view name) noexcept {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  name.remove_suffix(kSuffix.size());
  if (name.size() < kDigits || (name.size() > kDigits && name.front() == '0')) return std::nullopt;
  std::uint32_t number = 0;
  const char* const end = name.data() + name.size();
  const auto [at, error] = std::from_chars(name.data(), end, number);
  if (error != std::errc{} || at != end) return std::nullopt;
  return number;
}

std::vector<BlackboxEntry> list_blackbox(const std::filesystem::path& directory,
                                         std::error_code& error) {
  std::vector<BlackboxEntry> files;
  std::filesystem::directory_iterator at{directory, error};
  for (; !error && at != std::filesystem::directory_iterator{}; at.increment(error)) {
    const auto number = blackbox_file_number(at->path().filename().native());
    std::error_code gone;
    if (!number || !at->is_regular_file(gone)) continue;
    const std::uintmax_t bytes = at->file_size(gone);
    if (!gone) files.push_back({*number, bytes, at->path()});
  }
  std::ranges::sort(files, {}, &BlackboxEntry::number);
  return files;
}

bool is_blackbox(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) {
    return blackbox_file_number(path.filename().native()) || has_header(path);
  }
  if (!std::filesystem::is_directory(path, error)) return false;
  return std::filesystem::exists(path / kBlackboxLock, error) ||
         !list_blackbox(path, error).empty();
}

}  // namespace dampline::drivers
