// SPDX-License-Identifier: MIT
// How a BlackboxWriter comes to be.
#include "drivers/blackbox/writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "drivers/blackbox/shelf.hpp"

namespace dampline::drivers {
namespace {

// Below this much space a file that is begun again would soon be full.
constexpr std::uint64_t kWorthResuming = std::uint64_t{1} << 20U;

bool may_be_cured_by_a_new_file(int error) noexcept {
  return error != ENOSPC && error != EDQUOT && error != EROFS;
}

}  // namespace

BlackboxWriter::BlackboxWriter(BlackboxConfig config, Handles handles, BlackboxShelf shelf,
                               const BlackboxHeader& header)
    : config_{std::move(config)},
      handles_{std::move(handles)},
      shelf_{std::move(shelf)},
      header_{header},
      next_number_{shelf_.next_number()},
      next_sequence_{shelf_.next_sequence()},
      written_end_{next_sequence_} {}

BlackboxWriter::~BlackboxWriter() { finish_file(); }

void BlackboxWriter::do_write(const CanFrame& frame) noexcept {
  newest_ns_ = std::max(newest_ns_, frame.time_ns);
  add(frame);
}

void BlackboxWriter::do_write(const hal::Event& event) noexcept {
  newest_ns_ = std::max(newest_ns_, event.time_ns);
  add(event);
}

template <class Record>
void BlackboxWriter::add(const Record& record) noexcept {
  if (make_ready()) {
    put(record);
  } else {
    ++next_sequence_;
    lose(1);
  }
}

template <class Record>
void BlackboxWriter::put(const Record& record) noexcept {
  output_.append(record);
  ++next_sequence_;
}

/// True: there is a file, and room in the buffer.
bool BlackboxWriter::make_ready() noexcept {
  if (!health_.recording) return false;
  if (output_.is_open() && (output_.bytes() + kLongestRecord > config_.rotate_bytes ||
                            output_.records() == std::numeric_limits<std::uint32_t>::max())) {
    do_rotate();
  } else if (output_.is_open() && !output_.has_room()) {
    flush();
  }
  if (health_.recording && !output_.is_open()) return begin_file();
  return health_.recording;
}

bool BlackboxWriter::begin_file() noexcept {
  header_.file_number = next_number_++;
  header_.first_sequence = next_sequence_;
  header_.missing_before = next_sequence_ - written_end_;
  header_.created_ns = newest_ns_;
  if (const int error = output_.begin(handles_.directory, header_); error != 0) {
    stop(error, 0);
    return false;
  }
  ++health_.files;
  ++health_.syncs;
  health_.bytes += kRecordsAt;
  began_ns_ = now_ns_;
  if (std::exchange(rotated_, false)) {
    put(hal::Event{newest_ns_, hal::EventKind::kFileRotated, 0,
                   static_cast<std::int64_t>(next_sequence_)});
  }
  return true;
}

void BlackboxWriter::do_tick(std::int64_t monotonic_ns) noexcept {
  now_ns_ = monotonic_ns;
  if (!std::exchange(ticked_, true)) {
    began_ns_ = now_ns_;
    synced_ns_ = now_ns_;
    retry_at_ns_ = now_ns_;
  }
  if (!health_.recording && (now_ns_ < retry_at_ns_ || !resume())) return;
  if (!output_.is_open()) return;
  flush();
  if (output_.is_open() && now_ns_ - synced_ns_ >= config_.sync_interval_ns) {
    synced_ns_ = now_ns_;
    if (directory_gone()) return fail(ENOENT, true);
    if (output_.dirty()) sync();
    remove_old_files();
    keep_reserve();
  }
  if (output_.is_open() && now_ns_ - began_ns_ >= config_.rotate_ns) do_rotate();
}

void BlackboxWriter::do_rotate() noexcept {
  const bool was_open = output_.is_open();
  finish_file();
  rotated_ = rotated_ || (was_open && health_.recording && !output_.is_open());
}

void BlackboxWriter::do_close() noexcept { finish_file(); }

void BlackboxWriter::finish_file() noexcept {
  const std::uint32_t number = output_.number();
  if (!output_.is_open()) return;
  sync();
  if (!output_.is_open() || output_.number() != number) return;  // it failed
  shelf_.add(number, output_.bytes(), header_.created_ns);
  written_end_ = next_sequence_;
  output_.end();
  remove_old_files();
}

void BlackboxWriter::flush() noexcept {
  const int error = output_.flush();
  take_counts();
  if (error != 0) fail(error, false);
}

void BlackboxWriter::sync() noexcept {
  flush();
  if (!output_.is_open() || !output_.dirty()) return;
  const int error = output_.sync();
  if (error == 0) {
    ++health_.syncs;
    return;
  }
  ++health_.failed_syncs;
  fail(error, true);
}

void BlackboxWriter::take_counts() noexcept {
  const RecordCount written = output_.take_written();
  health_.frames += written.frames;
  health_.events += written.events;
  health_.bytes += written.bytes;
}

/// A write or sync failed, which is final for the file.
void BlackboxWriter::fail(int error, bool sync_failed) noexcept {
  const std::uint64_t lost = output_.abandon(handles_.directory, sync_failed);
  if (output_.bytes() > kRecordsAt)
    shelf_.add(output_.number(), output_.bytes(), header_.created_ns);
  written_end_ = header_.first_sequence + output_.whole_records();
  stop(error, lost);
  if (may_be_cured_by_a_new_file(error)) static_cast<void>(resume());
}

void BlackboxWriter::stop(int error, std::uint64_t lost) noexcept {
  health_.last_errno = error;
  health_.recording = false;
  stopped_errno_ = error;
  stopped_ns_ = newest_ns_;
  retry_at_ns_ = now_ns_ + config_.retry_ns;
  rotated_ = false;
  lost_since_stop_ = 0;
  lose(lost);
}

void BlackboxWriter::lose(std::uint64_t records) noexcept {
  health_.lost += records;
  lost_since_stop_ += records;
}

bool BlackboxWriter::resume() noexcept {
  const std::int64_t stopped_ns = stopped_ns_;
  const std::uint64_t lost = lost_since_stop_;
  const int error = stopped_errno_;
  retry_at_ns_ = now_ns_ + config_.retry_ns;
  if (directory_gone() && !make_directory_again()) return false;
  if (!has_space(kWorthResuming)) return false;
  health_.recording = true;
  if (!begin_file()) {  // stops again; the outage is still the same one
    stopped_ns_ = stopped_ns;
    stopped_errno_ = error;
    lost_since_stop_ = lost;
    return false;
  }
  put(hal::Event{stopped_ns, hal::EventKind::kRecordingStopped, 0, error});
  put(hal::Event{newest_ns_, hal::EventKind::kRecordingResumed, 0,
                 static_cast<std::int64_t>(lost)});
  return true;
}

void BlackboxWriter::remove_old_files() noexcept {
  const bool is_open = output_.is_open();
  health_.files_removed += shelf_.trim(handles_.directory, {config_.keep_bytes, config_.keep_ns},
                                       is_open ? output_.bytes() : 0,
                                       is_open ? header_.created_ns : newest_ns_, newest_ns_);
}

/// Stops before the file system is full, if asked to.
void BlackboxWriter::keep_reserve() noexcept {
  if (!output_.is_open() || has_space(0)) return;
  if (config_.keep_bytes > 0 && shelf_.remove_oldest(handles_.directory)) {
    ++health_.files_removed;
    return;  // the next turn looks again
  }
  finish_file();
  if (health_.recording && !output_.is_open()) stop(ENOSPC, 0);
}

bool BlackboxWriter::has_space(std::uint64_t beyond_reserve) const noexcept {
  struct statvfs space {};
  if (::fstatvfs(handles_.directory, &space) != 0) return true;
  return space.f_bavail * space.f_frsize >= config_.reserve_free_bytes + beyond_reserve;
}

bool BlackboxWriter::directory_gone() const noexcept {
  struct stat status {};
  return ::fstat(handles_.directory, &status) == 0 && status.st_nlink == 0;
}

bool BlackboxWriter::make_directory_again() noexcept {
  auto handles = take_directory(config_.directory);
  if (!handles.ok()) return false;
  handles_ = std::move(handles.value());
  shelf_ = {};
  return true;
}

namespace {

constexpr std::uint64_t kLeastRotateBytes = 4096;

std::string reason(int error) { return std::generic_category().message(error); }

Outcome<BlackboxHeader> header_of(const BlackboxConfig& config) {
  const std::string where = config.directory.string();
  if (config.interfaces.empty() || config.interfaces.size() > kMostInterfaces) {
    return Failure{Errc::kInvalidConfig,
                   fmt::format("{}: found {} interfaces, expected 1 to {}", where,
                               config.interfaces.size(), kMostInterfaces)};
  }
  BlackboxHeader header;
  header.interface_count = static_cast<std::uint8_t>(config.interfaces.size());
  for (std::size_t i = 0; i < config.interfaces.size(); ++i) {
    const std::string& name = config.interfaces[i];
    if (name.empty() || name.size() > kLongestName) {
      return Failure{Errc::kInvalidConfig,
                     fmt::format("{}: interface '{}': expected a name of 1 to {} characters", where,
                                 name, kLongestName)};
    }
    std::ranges::copy(name, header.interfaces.at(i).begin());
  }
  if (config.rotate_bytes < kLeastRotateBytes || config.rotate_ns <= 0 ||
      config.sync_interval_ns <= 0 || config.retry_ns <= 0 || config.keep_ns < 0) {
    return Failure{Errc::kInvalidConfig,
                   fmt::format("{}: expected files of {} bytes at least and times above 0", where,
                               kLeastRotateBytes)};
  }
  // Insecure is good enough to tell runs apart, and does not wait for entropy after a boot.
  if (::getrandom(&header.run_id, sizeof(header.run_id), GRND_INSECURE) != sizeof(header.run_id))
    return Failure{Errc::kIo, fmt::format("{}: no random number: {}", where, reason(errno))};
  return header;
}

/// Who holds the lock, as it says itself.
std::string holder(int lock) {
  std::array<char, 32> text{};
  const auto count = ::pread(lock, text.data(), text.size() - 1, 0);
  const std::string_view who{text.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  return who.empty() ? "another program" : fmt::format("process {}", who);
}

int lock_file(int directory, std::string& failed) {
  const int lock =
      ::openat(directory, kBlackboxLock.data(), O_RDWR | O_CREAT | O_CLOEXEC, kFileMode);
  if (lock < 0) {
    failed = fmt::format("{}: cannot be made: {}", kBlackboxLock, reason(errno));
    return -1;
  }
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    failed = errno == EWOULDBLOCK
                 ? fmt::format("is being written to by {}, expected one writer", holder(lock))
                 : fmt::format("{}: cannot be locked: {}", kBlackboxLock, reason(errno));
    ::close(lock);
    return -1;
  }
  const std::string pid = fmt::format("{}", ::getpid());
  // For the message above only.
  [[maybe_unused]] const bool told =
      ::ftruncate(lock, 0) == 0 && ::pwrite(lock, pid.data(), pid.size(), 0) > 0;
  return lock;
}

/// The name of a new directory is on the disk only when its parent is.
void sync_parent(const std::filesystem::path& directory) {
  const int parent = ::open((directory / "..").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (parent < 0) return;
  static_cast<void>(::fsync(parent));
  ::close(parent);
}

}  // namespace

BlackboxWriter::Handles::Handles(Handles&& other) noexcept
    : directory{std::exchange(other.directory, -1)}, lock{std::exchange(other.lock, -1)} {}

BlackboxWriter::Handles& BlackboxWriter::Handles::operator=(Handles&& other) noexcept {
  std::swap(directory, other.directory);
  std::swap(lock, other.lock);
  return *this;
}

BlackboxWriter::Handles::~Handles() {
  if (lock >= 0) ::close(lock);
  if (directory >= 0) ::close(directory);
}

Outcome<BlackboxWriter::Handles> BlackboxWriter::take_directory(
    const std::filesystem::path& directory) {
  const auto failure = [&](const std::string& what) {
    return Failure{Errc::kIo, fmt::format("{}: {}", directory.string(), what)};
  };
  std::error_code error;
  const bool made = std::filesystem::create_directories(directory, error);
  if (error) return failure(fmt::format("cannot be made: {}", error.message()));
  if (made) sync_parent(directory);
  Handles handles;
  handles.directory = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handles.directory < 0) return failure(fmt::format("cannot be opened: {}", reason(errno)));
  std::string failed;
  handles.lock = lock_file(handles.directory, failed);
  if (handles.lock < 0) return failure(failed);
  return handles;
}

Outcome<std::unique_ptr<BlackboxWriter>> BlackboxWriter::open(const BlackboxConfig& config) {
  const auto header = header_of(config);
  if (!header.ok()) return header.failure();
  auto handles = take_directory(config.directory);
  if (!handles.ok()) return handles.failure();
  auto shelf = BlackboxShelf::scan(config.directory);
  if (!shelf.ok()) return shelf.failure();
  return std::unique_ptr<BlackboxWriter>{new BlackboxWriter{
      config, std::move(handles.value()), std::move(shelf.value()), header.value()}};
}

}  // namespace dampline::drivers
