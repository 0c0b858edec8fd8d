// SPDX-License-Identifier: MIT
#include "drivers/blackbox/shelf.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <system_error>

#include "drivers/blackbox/file_reader.hpp"
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
    if (gone == std::errc::no_such_file_or_directory) continue;
    files.push_back({*number, gone ? 0 : bytes, at->path()});  // who reads it says what is wrong
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

namespace {

using Opened = BlackboxFileReader::Opened;

constexpr std::uint64_t kTailBytes = std::uint64_t{1} << 20U;
constexpr std::size_t kUsualFiles = 4096;  // so that rotation seldom allocates

/// The sequence behind the last whole record of a file; nothing when it cannot be read.
std::optional<std::uint64_t> end_of(BlackboxFileReader& reader, const char* path) {
  for (const bool tail_only : {true, false}) {
    if (reader.open(path) != Opened::kOpen) return std::nullopt;
    if (tail_only) reader.skip_to_tail(kTailBytes);
    BlackboxRecord record;
    std::optional<std::uint64_t> end;
    while (reader.next(record) == BlackboxFileReader::Status::kRecord)
      end = reader.header().first_sequence + record.number + 1;
    if (end) return end;
  }
  return reader.header().first_sequence;
}

}  // namespace

Outcome<BlackboxShelf> BlackboxShelf::scan(const std::filesystem::path& directory) {
  std::error_code error;
  const std::vector<BlackboxEntry> found = list_blackbox(directory, error);
  if (error) {
    return Failure{Errc::kIo,
                   fmt::format("{}: cannot be listed: {}", directory.string(), error.message())};
  }
  BlackboxShelf shelf;
  shelf.files_.reserve(std::max(kUsualFiles, 2 * found.size()));
  BlackboxFileReader reader;
  std::int64_t created_ns = 0;
  for (const BlackboxEntry& file : found) {
    const Opened opened = reader.open(file.path.c_str());
    if (opened == Opened::kOtherVersion) {
      return Failure{Errc::kMismatch,
                     fmt::format("{}: is of format version {}, this program writes {}; expected an "
                                 "empty directory or one of this version",
                                 file.path.string(), reader.header().version, kBlackboxVersion)};
    }
    if (opened == Opened::kOpen) created_ns = reader.header().created_ns;
    shelf.add(file.number, file.bytes, created_ns);
  }
  if (!found.empty()) shelf.next_number_ = found.back().number + 1;
  std::optional<std::uint64_t> end;
  for (std::size_t i = found.size(); i > 0 && !end; --i)
    end = end_of(reader, found[i - 1].path.c_str());
  if (end) shelf.next_sequence_ = *end;
  return shelf;
}

void BlackboxShelf::add(std::uint32_t number, std::uint64_t bytes, std::int64_t created_ns) {
  files_.push_back({number, bytes, created_ns});
  bytes_ += bytes;
}

bool BlackboxShelf::oldest_is_due(const Retention& retention, std::uint64_t current_bytes,
                                  std::int64_t current_created_ns,
                                  std::int64_t now_ns) const noexcept {
  if (files_.empty()) return false;
  if (retention.keep_bytes > 0 && bytes_ + current_bytes > retention.keep_bytes) return true;
  // A file's records are older than the next file.
  const std::int64_t end_ns = files_.size() > 1 ? files_[1].created_ns : current_created_ns;
  return retention.keep_ns > 0 && end_ns < now_ns - retention.keep_ns;
}

std::uint64_t BlackboxShelf::trim(int directory, const Retention& retention,
                                  std::uint64_t current_bytes, std::int64_t current_created_ns,
                                  std::int64_t now_ns) noexcept {
  std::uint64_t removed = 0;
  while (oldest_is_due(retention, current_bytes, current_created_ns, now_ns)) {
    if (remove_oldest(directory)) ++removed;
  }
  return removed;
}

bool BlackboxShelf::remove_oldest(int directory) noexcept {
  if (files_.empty()) return false;
  const std::string name = blackbox_file_name(files_.front().number);
  bytes_ -= files_.front().bytes;
  files_.erase(files_.begin());
  return ::unlinkat(directory, name.c_str(), 0) == 0;
}

}  // namespace dampline::drivers
