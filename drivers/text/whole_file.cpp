// SPDX-License-Identifier: MIT
#include "drivers/text/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

namespace dampline::drivers {
namespace {

constexpr std::size_t kPartBytes = std::size_t{1} << 18U;

Failure cannot_read(const std::string& path) {
  return {Errc::kIo, fmt::format("{}: cannot be read: {}", path, std::strerror(errno))};
}

/// Does not wait for a pipe's writer; reading waits.
int open_to_read(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (file >= 0) static_cast<void>(::fcntl(file, F_SETFL, 0));
  return file;
}

}  // namespace

Outcome<std::uint64_t> read_parts(const std::string& path,
                                  const std::function<bool(std::span<const char>)>& take) {
  const int file = open_to_read(path);
  if (file < 0) return cannot_read(path);
  std::vector<char> part(kPartBytes);
  std::uint64_t bytes = 0;
  for (;;) {
    const ssize_t count = ::read(file, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      Failure failure = cannot_read(path);
      ::close(file);
      return failure;
    }
    bytes += static_cast<std::uint64_t>(count);
    if (count > 0 && take({part.data(), static_cast<std::size_t>(count)})) continue;
    ::close(file);
    return bytes;
  }
}

Outcome<std::string> read_whole(const std::string& path, std::size_t most) {
  std::string text;
  const auto read = read_parts(path, [&](std::span<const char> part) {
    text.append(part.data(), part.size());
    return text.size() <= most;
  });
  if (!read) return read.failure();
  if (text.size() > most)
    return Failure{Errc::kMalformed,
                   fmt::format("{}: is larger than {} bytes, expected at most that", path, most)};
  return text;
}

}  // namespace dampline::drivers
