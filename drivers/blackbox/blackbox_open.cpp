// SPDX-License-Identifier: MIT
// How a BlackboxWriter comes to be.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>
#include <utility>

#include "drivers/blackbox/blackbox_writer.hpp"
#include "drivers/blackbox/file_names.hpp"

namespace dampline::drivers {
namespace {

constexpr int kMode = 0644;
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
    if (name.empty() || name.size() > kLongestInterface) {
      return Failure{Errc::kInvalidConfig,
                     fmt::format("{}: interface '{}': expected a name of 1 to {} characters", where,
                                 name, kLongestInterface)};
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
  const int lock = ::openat(directory, kBlackboxLock.data(), O_RDWR | O_CREAT | O_CLOEXEC, kMode);
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
  if (::ftruncate(lock, 0) == 0) static_cast<void>(::pwrite(lock, pid.data(), pid.size(), 0));
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
