// SPDX-License-Identifier: MIT
#include "drivers/bytes/spool.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <span>

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

}  // namespace

Outcome<std::string> spooled(const std::string& path) {
  struct stat status {};
  if (path != "-" && ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
      !is_compressed(path))
    return path;
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

}  // namespace dampline::drivers
