// SPDX-License-Identifier: MIT
#include "app/fleet/spool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "app/run/disk.hpp"
#include "app/text/format.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kState = ".dls";
constexpr std::string_view kSent = ".sent";
constexpr std::size_t kChecksumBytes = 4;  // at the end of a state

fs::path marker_of(fs::path state) { return state.replace_extension(kSent); }

/// A state is known by its own checksum, its last bytes.
std::string mark_of(std::string_view bytes) {
  std::string out;
  for (const char c : bytes.substr(bytes.size() - std::min(bytes.size(), kChecksumBytes)))
    out += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return out + "\n";
}

std::string tail_of(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  stream.seekg(-static_cast<std::streamoff>(kChecksumBytes), std::ios::end);
  std::array<char, kChecksumBytes> tail{};
  stream.read(tail.data(), tail.size());
  return {tail.data(), static_cast<std::size_t>(stream.gcount())};
}

void remove_state(const fs::path& file) {
  std::error_code gone;  // another run's spool, or a reader's hand
  fs::remove(marker_of(file), gone);
  fs::remove(file, gone);
}

}  // namespace

std::string segment_token(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '-' || c == '_';
    out += plain ? std::string{c} : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string segment_name(const Segment& segment) {
  return fmt::format("{}.{}.{}", segment_token(segment.vehicle), segment_token(segment.truck),
                     segment.start_ns) +
         (segment.record == 0 ? "" : fmt::format("-{:016x}", segment.record));
}

bool was_sent(const fs::path& state) {
  std::ifstream stream{marker_of(state), std::ios::binary};
  const std::string mark{std::istreambuf_iterator<char>{stream}, {}};
  return !mark.empty() && mark == mark_of(tail_of(state));
}

void mark_sent(const fs::path& state, std::string_view bytes) {
  write_file(marker_of(state), mark_of(bytes));
}

Spool::Spool(const SpoolSettings& settings, const RecordLabels& record)
    : folder_{settings.folder},
      keep_bytes_{static_cast<std::uintmax_t>(settings.keep_mib) << 20U},
      reserve_bytes_{static_cast<std::uintmax_t>(settings.reserve_free_mib) << 20U} {
  if (record.vehicle.empty() || record.truck.empty())
    throw UsageError{
        "[record] vehicle, truck: empty, expected the names by which the fleet knows the states "
        "of [spool]"};
  constexpr std::size_t kLongestName = 200;  // of a file, 255, with what else is in it
  if (segment_name({record.vehicle, record.truck, 0, 0}).size() > kLongestName)
    throw UsageError{
        fmt::format("[record] vehicle, truck: too long for a file's name in [spool]; expected {} "
                    "letters, others count three",
                    kLongestName)};
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) fail_io(folder_, "create", error.value());
  remove_stale(folder_, std::string{kPartial});
}

void Spool::put(const Segment& segment, std::string bytes) {
  waiting_[segment_name(segment)] = std::move(bytes);
  if (waiting_.size() > kMostWaiting) {
    waiting_.erase(waiting_.begin());
    ++health_.dropped;
  }
  write_waiting();
}

void Spool::write_waiting() {
  while (!waiting_.empty()) {
    const auto& [name, bytes] = *waiting_.begin();
    try {
      make_room(bytes.size());
      write_file(folder_ / (name + std::string{kState}), bytes);
    } catch (const RunError& error) {
      ++health_.failures;
      health_.error = error.what();
      return;
    }
    waiting_.erase(waiting_.begin());
  }
}

std::vector<Spool::Entry> Spool::entries() const {
  std::vector<Entry> out;
  std::error_code error;
  for (fs::directory_iterator at{folder_, error}; !error && at != fs::directory_iterator{};
       at.increment(error)) {
    const fs::path& file = at->path();
    std::error_code gone;
    const std::uintmax_t bytes = fs::file_size(file, gone);
    if (gone || file.extension() != kState) continue;
    const std::string start = file.stem().extension().string();
    out.push_back({{start.size(), start}, file, bytes});
  }
  std::sort(out.begin(), out.end(),
            [](const Entry& a, const Entry& b) { return a.start < b.start; });
  return out;
}

bool Spool::disk_has(std::uintmax_t bytes) const {
  std::error_code error;
  const fs::space_info space = fs::space(folder_, error);
  return error || space.available >= reserve_bytes_ + bytes;
}

void Spool::make_room(std::uintmax_t bytes) {
  const std::vector<Entry> all = entries();
  std::uintmax_t held = bytes;
  for (const Entry& entry : all) held += entry.bytes;
  const auto remove_oldest = [&](bool sent, const auto& is_enough) {
    for (const Entry& entry : all) {
      if (is_enough()) return;
      std::error_code gone;
      if (!fs::exists(entry.file, gone) || was_sent(entry.file) != sent) continue;
      remove_state(entry.file);
      held -= entry.bytes;
      if (!sent) ++health_.dropped;
    }
  };
  remove_oldest(true, [&] { return held <= keep_bytes_ && disk_has(bytes); });
  remove_oldest(false, [&] { return held <= keep_bytes_; });
  if (!disk_has(bytes)) throw RunError{fmt::format("{}: the disk is full", folder_.string())};
}

std::vector<std::string> Spool::warnings() const {
  std::vector<std::string> out;
  if (health_.failures > 0)
    out.push_back(fmt::format("[spool]: {} states found no room, {} of which wait: {}.",
                              format_count(health_.failures), waiting_.size(), health_.error));
  if (health_.dropped > 0)
    out.push_back(fmt::format(
        "[spool]: {} segments went before they were sent: the folder is full ([spool] keep_mib).",
        format_count(health_.dropped)));
  return out;
}

}  // namespace dampline::app::fleet
