// SPDX-License-Identifier: MIT
#include "drivers/bytes/byte_stream.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <nettle/sha2.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace dampline::drivers {
namespace {

constexpr std::size_t kRawBuffer = std::size_t{64} * 1024;

Failure cannot_open(const std::string& path, int error_number) {
  return {Errc::kIo, fmt::format("{}: cannot be opened: {}", path, std::strerror(error_number))};
}

/// Standard input. Of a file one that has its own place in it and begins where the shell has it.
int open_standard_input() noexcept {
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode)) {
    const int own = ::open("/proc/self/fd/0", O_RDONLY | O_CLOEXEC);
    const off_t begin = ::lseek(STDIN_FILENO, 0, SEEK_CUR);
    if (own >= 0 && begin >= 0 && ::lseek(own, begin, SEEK_SET) == begin) return own;
    if (own >= 0) ::close(own);
  }
  return ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
}

}  // namespace

/// A pipe's first bytes, and its end held open between two openings.
struct ByteStream::Pipe {
  dev_t device{};
  ino_t number{};
  int descriptor{-1};
  std::vector<char> bytes;
  bool passed{false};  // more than what is kept was read
  sha256_ctx sum{};
  std::uint64_t count{0};  // bytes in `sum`
  bool ended{false};

  Pipe(const struct stat& status, int from)
      : device{status.st_dev},
        number{status.st_ino},
        descriptor{::fcntl(from, F_DUPFD_CLOEXEC, 0)} {
    ::sha256_init(&sum);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

std::vector<std::shared_ptr<ByteStream::Pipe>>& ByteStream::pipes() {
  static std::vector<std::shared_ptr<Pipe>> all;
  return all;
}

std::optional<ByteStream::Passed> ByteStream::passed_through(const std::string& path) {
  struct stat status {};
  if ((path == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(path.c_str(), &status)) != 0)
    return std::nullopt;
  for (const auto& pipe : pipes()) {
    if (!pipe->ended || pipe->device != status.st_dev || pipe->number != status.st_ino) continue;
    sha256_ctx sum = pipe->sum;
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    ::sha256_digest(&sum, digest.size(), digest.data());
    Passed out{pipe->count, {}};
    for (const std::uint8_t byte : digest) out.sha256 += fmt::format("{:02x}", byte);
    return out;
  }
  return std::nullopt;
}

std::shared_ptr<ByteStream::Pipe> ByteStream::pipe_of(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return nullptr;
  const bool terminal = S_ISCHR(status.st_mode) && ::isatty(descriptor) != 0;
  if (!S_ISFIFO(status.st_mode) && !S_ISSOCK(status.st_mode) && !terminal) return nullptr;
  for (const auto& pipe : pipes())
    if (pipe->device == status.st_dev && pipe->number == status.st_ino) return pipe;
  return pipes().emplace_back(std::make_shared<Pipe>(status, descriptor));
}

Outcome<ByteStream> ByteStream::open(const std::string& path) {
  const bool is_stdin = path == "-";
  // A file is opened without waiting for a writer; reading a named pipe polls first.
  const int descriptor =
      is_stdin ? open_standard_input() : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return cannot_open(path, errno);
  ByteStream out{is_stdin ? "standard input" : path, descriptor};
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return cannot_open(path, errno);
  if (S_ISDIR(status.st_mode)) return cannot_open(path, EISDIR);
  out.may_block_ = !S_ISREG(status.st_mode);
  out.pipe_ = pipe_of(descriptor);
  if (out.pipe_ && out.pipe_->passed)
    return Failure{
        Errc::kIo,
        fmt::format("{}: was read already and cannot be read again; expected a file", out.name_)};
  if (!out.may_block_) {
    static_cast<void>(::posix_fadvise(descriptor, 0, 0, POSIX_FADV_SEQUENTIAL));
    const off_t begin = ::lseek(descriptor, 0, SEEK_CUR);
    if (begin >= 0 && status.st_size > begin)
      out.size_ = static_cast<std::uint64_t>(status.st_size - begin);
  }
  return out;
}

ByteStream::ByteStream(std::string name, int descriptor)
    : name_{std::move(name)}, descriptor_{descriptor} {}

ByteStream::ByteStream(ByteStream&& other) noexcept
    : name_{std::move(other.name_)},
      descriptor_{std::exchange(other.descriptor_, -1)},
      may_block_{other.may_block_},
      pipe_{std::move(other.pipe_)},
      pipe_at_{other.pipe_at_},
      size_{other.size_},
      raw_at_{other.raw_at_},
      mode_{other.mode_},
      first_{other.first_},
      first_count_{other.first_count_},
      decompressor_{std::move(other.decompressor_)},
      raw_{std::move(other.raw_)},
      raw_begin_{other.raw_begin_},
      raw_end_{other.raw_end_},
      raw_ended_{other.raw_ended_},
      cut_off_{other.cut_off_},
      error_{other.error_},
      fault_{other.fault_},
      error_number_{other.error_number_} {}

ByteStream::~ByteStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool ByteStream::readable(int timeout_ms) const noexcept {
  pollfd request{descriptor_, POLLIN, 0};
  return ::poll(&request, 1, timeout_ms) > 0;
}

bool ByteStream::wait(std::chrono::nanoseconds timeout) noexcept {
  if (!may_block_ || fault_ != nullptr || error_number_ != 0 || raw_ended_) return true;
  if (pipe_ && pipe_at_ < pipe_->bytes.size()) return true;
  const auto timeout_ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  return readable(static_cast<int>(std::clamp<std::int64_t>(timeout_ms, 0, 1'000'000'000)));
}

ByteStream::Read ByteStream::read(std::span<char> out) noexcept {
  if (mode_ == Mode::kPlain) return read_raw(out);
  if (mode_ == Mode::kUnknown) return read_first(out);
  return read_compressed(out);
}

// The file's own bytes. What a pipe gives is kept, and given again to a stream opened later.
ByteStream::Read ByteStream::read_raw(std::span<char> out) noexcept {
  if (pipe_ && pipe_at_ < pipe_->bytes.size()) {
    const std::size_t count = std::min(out.size(), pipe_->bytes.size() - pipe_at_);
    std::memcpy(out.data(), pipe_->bytes.data() + pipe_at_, count);
    pipe_at_ += count;
    return {Status::kBytes, count};
  }
  if (may_block_ && !readable(0)) return {Status::kNothingYet, 0};
  const ssize_t count = ::read(descriptor_, out.data(), out.size());
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return {Status::kNothingYet, 0};
  if (count < 0) {
    error_number_ = errno;
    return {Status::kError, 0};
  }
  if (count == 0) {
    if (pipe_) pipe_->ended = true;
    return {Status::kEnd, 0};
  }
  const auto bytes = static_cast<std::size_t>(count);
  raw_at_ += bytes;
  if (pipe_) {
    ::sha256_update(&pipe_->sum, bytes, reinterpret_cast<const std::uint8_t*>(out.data()));
    pipe_->count += bytes;
  }
  if (pipe_ && !pipe_->passed) {
    if (pipe_at_ == pipe_->bytes.size() && pipe_at_ + bytes <= kKept) {
      pipe_->bytes.insert(pipe_->bytes.end(), out.begin(), out.begin() + count);
      pipe_at_ += bytes;
    } else {
      pipe_->passed = true;
      pipe_->bytes = {};
      pipe_at_ = 0;
    }
  }
  return {Status::kBytes, bytes};
}

// Until the first bytes have said what the file is.
ByteStream::Read ByteStream::read_first(std::span<char> out) noexcept {
  const std::span<char> rest = std::span{first_}.subspan(first_count_);
  const Read part = read_raw(rest);
  if (part.status == Status::kNothingYet || part.status == Status::kError) return part;
  first_count_ += part.count;
  const std::string_view head{first_.data(), first_count_};
  const Compression found = compression_of(head);
  if (found == Compression::kNone && part.status == Status::kBytes && head.size() < first_.size() &&
      may_become_compressed(head))
    return {Status::kNothingYet, 0};
  if (found != Compression::kNone) {
    if (!start_decompressor(found)) return fail(Errc::kIo, "no memory to decompress it");
    return read_compressed(out);
  }
  const std::size_t count = std::min(out.size(), first_count_);
  std::memcpy(out.data(), first_.data(), count);
  std::memmove(first_.data(), first_.data() + count, first_count_ - count);
  first_count_ -= count;
  if (first_count_ == 0) mode_ = Mode::kPlain;
  if (count == 0) return {Status::kEnd, 0};
  return {Status::kBytes, count};
}

bool ByteStream::start_decompressor(Compression compression) noexcept {
  mode_ = Mode::kCompressed;
  decompressor_ = compression == Compression::kGzip ? make_gzip() : make_zstd();
  raw_.resize(kRawBuffer);
  std::memcpy(raw_.data(), first_.data(), first_count_);
  raw_begin_ = 0;
  raw_end_ = first_count_;
  return decompressor_ != nullptr;
}

ByteStream::Read ByteStream::read_compressed(std::span<char> out) noexcept {
  if (fault_ != nullptr) return {Status::kError, 0};
  for (;;) {
    const auto step =
        decompressor_->push(std::span{raw_}.subspan(raw_begin_, raw_end_ - raw_begin_), out);
    raw_begin_ += step.taken;
    if (step.fault != nullptr) static_cast<void>(fail(Errc::kMalformed, step.fault));
    if (step.given > 0) return {Status::kBytes, step.given};
    if (step.fault != nullptr) return {Status::kError, 0};
    if (raw_begin_ < raw_end_) continue;
    if (raw_ended_) {
      cut_off_ = !decompressor_->is_whole();
      return {Status::kEnd, 0};
    }
    raw_begin_ = 0;
    const Read part = read_raw(raw_);
    raw_end_ = part.count;
    raw_ended_ = part.status == Status::kEnd;
    if (part.status == Status::kNothingYet || part.status == Status::kError) return part;
  }
}

ByteStream::Read ByteStream::fail(Errc error, const char* text) noexcept {
  error_ = error;
  fault_ = text;
  return {Status::kError, 0};
}

std::string ByteStream::error_text() const {
  if (fault_ == nullptr)
    return fmt::format("{}: cannot be read: {}", name_, std::strerror(error_number_));
  return fmt::format("{}: its compressed data are damaged before byte {}: {}", name_, raw_at_,
                     fault_);
}

std::optional<double> ByteStream::share_read() const noexcept {
  if (size_ == 0) return std::nullopt;
  return std::min(1.0, static_cast<double>(raw_at_) / static_cast<double>(size_));
}

}  // namespace dampline::drivers
