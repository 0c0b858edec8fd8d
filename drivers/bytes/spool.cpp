// SPDX-License-Identifier: MIT
#include "drivers/bytes/spool.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <span>
#include <utility>

#include "drivers/bytes/byte_stream.hpp"

namespace dampline::drivers {
namespace {

bool is_compressed(const std::string& path) {
  std::ifstream stream{path, std::ios::binary};
  std::array<char, 4> head{};
  stream.read(head.data(), head.size());
  return compression_of({head.data(), static_cast<std::size_t>(stream.gcount())}) !=
         Compression::kNone;
}

Outcome<std::string> copied(const std::string& path) {
  auto opened = ByteStream::open(path);
  if (!opened) return opened.failure();
  ByteStream& stream = opened.value();
  // It stays open: the copy lasts as long as the process.
  std::FILE* file = std::tmpfile();  // NOLINT(*-owning-memory)
  const auto cannot = [&] {
    return Failure{Errc::kIo, fmt::format("{}: cannot be copied to a temporary file: {}",
                                          stream.name(), std::strerror(errno))};
  };
  if (file == nullptr) return cannot();
  std::array<char, 65536> part{};
  for (;;) {
    const ByteStream::Read read = stream.read(part);
    if (read.status == ByteStream::Status::kError)
      return Failure{stream.error(), stream.error_text()};
    if (read.status == ByteStream::Status::kEnd) break;
    if (read.count == 0) static_cast<void>(stream.wait(std::chrono::seconds{1}));
    if (std::fwrite(part.data(), 1, read.count, file) != read.count) return cannot();
  }
  if (std::fflush(file) != 0) return cannot();
  return fmt::format("/proc/self/fd/{}", ::fileno(file));
}

struct stat status_of(const std::string& path) {
  struct stat status {};
  if (path == "-")
    static_cast<void>(::fstat(STDIN_FILENO, &status));
  else
    static_cast<void>(::stat(path.c_str(), &status));
  return status;
}

/// Of a pipe, which gives its bytes once.
std::string& copy_of(const struct stat& pipe) {
  static std::map<std::pair<dev_t, ino_t>, std::string> copies;
  return copies[{pipe.st_dev, pipe.st_ino}];
}

}  // namespace

Outcome<std::string> spooled(const std::string& path) {
  const struct stat status = status_of(path);
  if (S_ISREG(status.st_mode))
    return path != "-" && !is_compressed(path) ? Outcome<std::string>{path} : copied(path);
  std::string& copy = copy_of(status);
  if (!copy.empty()) return copy;
  auto made = copied(path);
  if (made) copy = made.value();
  return made;
}

std::string spooled_before(const std::string& path) {
  const struct stat status = status_of(path);
  if (S_ISREG(status.st_mode) || status.st_ino == 0) return path;
  const std::string& copy = copy_of(status);
  return copy.empty() ? path : copy;
}

}  // namespace dampline::drivers
