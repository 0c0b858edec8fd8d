// SPDX-License-Identifier: MIT
#include "drivers/blackbox/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "drivers/blackbox/shelf.hpp"

namespace dampline::drivers {
namespace {

int result_of(int call) noexcept { return call == 0 ? 0 : errno; }

}  // namespace

BlackboxOutput::BlackboxOutput() : buffer_(kBuffer) {}

BlackboxOutput::~BlackboxOutput() { close(); }

void BlackboxOutput::close() noexcept {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

int BlackboxOutput::begin(int directory, const BlackboxHeader& header) noexcept {
  const std::string name = blackbox_file_name(header.file_number);
  file_ = ::openat(directory, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kFileMode);
  if (file_ < 0) return errno;
  std::array<std::uint8_t, kRecordsAt> bytes{};
  encode_header(header, bytes);
  std::size_t done = 0;
  int error = write_all(bytes.data(), bytes.size(), done);
  if (error == 0) error = result_of(::fdatasync(file_));
  if (error == 0) error = result_of(::fsync(directory));
  if (error != 0) {
    close();
    ::unlinkat(directory, name.c_str(), 0);
    return error;
  }
  header_ = header;
  seed_ = header.checksum_seed();
  records_ = 0;
  whole_ = 0;
  written_ = kRecordsAt;
  unsynced_ = 0;
  buffered_ = {};
  new_written_ = {};
  used_ = 0;
  return 0;
}

void BlackboxOutput::append(const CanFrame& frame) noexcept {
  used_ += encode_frame(frame, records_++, seed_, buffer_.data() + used_);
  ++buffered_.frames;
}

void BlackboxOutput::append(const hal::Event& event) noexcept {
  used_ += encode_event(event, records_++, seed_, buffer_.data() + used_);
  ++buffered_.events;
}

int BlackboxOutput::write_all(const std::uint8_t* data, std::size_t bytes,
                              std::size_t& done) const noexcept {
  while (done < bytes) {
    const auto count = ::write(file_, data + done, bytes - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) return EIO;
    done += static_cast<std::size_t>(count);
  }
  return 0;
}

int BlackboxOutput::flush() noexcept {
  std::size_t done = 0;
  const int error = write_all(buffer_.data(), used_, done);
  count_whole(done);
  return error;
}

// Of the first `done` bytes of the buffer, the whole records become the file's.
void BlackboxOutput::count_whole(std::size_t done) noexcept {
  std::size_t at = 0;
  while (at < used_) {
    const std::size_t next = at + kRecordHead + buffer_[at + kRecordLengthAt] + kRecordTail;
    if (next > done) break;
    const bool frame = buffer_[at + kRecordTypeAt] == kFrameRecord;
    ++(frame ? new_written_.frames : new_written_.events);
    --(frame ? buffered_.frames : buffered_.events);
    ++unsynced_;
    ++whole_;
    at = next;
  }
  written_ += at;
  new_written_.bytes += at;
  used_ = 0;
}

int BlackboxOutput::sync() noexcept {
  if (const int error = flush(); error != 0) return error;
  if (::fdatasync(file_) != 0) return errno;
  unsynced_ = 0;
  return 0;
}

void BlackboxOutput::end() noexcept { close(); }

std::uint64_t BlackboxOutput::abandon(int directory, bool sync_failed) noexcept {
  std::uint64_t lost = std::exchange(buffered_, {}).all();
  used_ = 0;
  const bool cut = ::ftruncate(file_, static_cast<off_t>(written_)) == 0;
  if (sync_failed || ::fdatasync(file_) != 0) lost += unsynced_;
  unsynced_ = 0;
  close();
  if (cut && written_ == kRecordsAt)
    ::unlinkat(directory, blackbox_file_name(header_.file_number).c_str(), 0);
  return lost;
}

RecordCount BlackboxOutput::take_written() noexcept { return std::exchange(new_written_, {}); }

}  // namespace dampline::drivers
