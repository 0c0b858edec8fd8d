// SPDX-License-Identifier: MIT
#include "drivers/bytes/file_range.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace dampline::drivers {

Outcome<std::shared_ptr<RandomFile>> RandomFile::open(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    return Failure{Errc::kIo, fmt::format("{}: cannot be opened: {}", path, std::strerror(reason))};
  }
  return std::shared_ptr<RandomFile>{
      new RandomFile{descriptor, static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0))}};
}

RandomFile::~RandomFile() { ::close(descriptor_); }

std::size_t RandomFile::read(std::uint64_t offset, std::span<char> out) const noexcept {
  std::size_t done = 0;
  while (done < out.size() && offset + done < size_) {
    const ssize_t count = ::pread(descriptor_, out.data() + done, out.size() - done,
                                  static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

std::size_t FileRange::read_some(std::span<char> out) noexcept {
  const std::size_t most = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), left_));
  const std::size_t count = file_->read(next_, out.first(most));
  next_ += count;
  left_ = count == 0 ? 0 : left_ - count;
  return count;
}

bool FileRange::fill() noexcept {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const auto room = std::span{buffer_}.subspan(end_);
  if (!inflate_) {
    const std::size_t count = read_some(room);
    end_ += count;
    return count > 0;
  }
  packed_.resize(kPacked);
  for (;;) {
    if (packed_begin_ == packed_end_) {
      packed_begin_ = 0;
      packed_end_ = read_some(packed_);
    }
    const auto step = inflate_->push(
        std::span{packed_}.subspan(packed_begin_, packed_end_ - packed_begin_), room);
    packed_begin_ += step.taken;
    end_ += step.given;
    if (step.given > 0) return true;
    if (step.fault != nullptr || packed_end_ == 0 || inflate_->is_whole()) return false;
  }
}

std::span<const char> FileRange::look(std::size_t count) noexcept {
  while (end_ - begin_ < count && fill()) {
  }
  return std::span{buffer_}.subspan(begin_, std::min(count, end_ - begin_));
}

}  // namespace dampline::drivers
