// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/bytes/byte_reader.hpp"
#include "drivers/compressed/decompressor.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/record/time_gate.hpp"

namespace dampline::drivers {

/// Vector's BLF as a source of frames: CAN_MESSAGE, CAN_MESSAGE2, CAN_FD_MESSAGE, CAN_FD_MESSAGE_64
/// and CAN_ERROR_EXT, in zlib-compressed or plain containers or without one; other objects count as
/// ignored. Channels become "can1", "can2", ... Times are the begin of the measurement, which the
/// file has in local time to 1 ms, plus each object's own in ns or 10 us. In constant memory,
/// whatever sizes the file states. Bytes that are no object where one is due are an error with the
/// offset of their container, or with skip_bad_lines passed over to the next object and counted. A
/// file that ends within an object sets truncated. Written by the format as python-can has it.
class BlfSource final : public RecordedFrames {
 public:
  static Outcome<std::unique_ptr<RecordedFrames>> open(const FrameFileConfig& config);
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return file_.stream().share_read();
  }
  [[nodiscard]] RecordClock clock() const noexcept override {
    return start_ns_ > 0 ? RecordClock::kLocal : RecordClock::kRelative;
  }

 private:
  BlfSource(const FrameFileConfig& config, ByteStream stream);
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept override {
    return stopped() || file_.stream().wait(timeout);
  }

  using Status = ByteStream::Status;
  [[nodiscard]] Status take_file_header() noexcept;
  [[nodiscard]] Status need_objects(std::size_t count) noexcept;
  [[nodiscard]] Status fill_objects() noexcept;
  [[nodiscard]] Status begin_container() noexcept;
  [[nodiscard]] std::span<const char> objects() const noexcept {
    return std::span{objects_}.subspan(objects_begin_, objects_end_ - objects_begin_);
  }
  [[nodiscard]] Step read_one(CanFrame& frame) noexcept override;
  Step take_object(CanFrame& frame) noexcept;
  Step deliver(CanFrame& frame, std::uint32_t channel) noexcept;
  Step no_object() noexcept;
  Step end(Status status) noexcept;

  ByteReader file_;
  bool header_taken_{false};
  std::int64_t start_ns_{0};  // since 1970 in local time; 0: the file does not say
  std::unique_ptr<Decompressor> inflate_;
  bool compressed_{false};
  std::uint64_t container_at_{0};    // offset of the container's header
  std::uint64_t container_left_{0};  // of its content, as it lies in the file
  std::vector<char> objects_;        // the content of the containers, one behind the other
  std::size_t objects_begin_{0};
  std::size_t objects_end_{0};
  std::uint64_t skip_left_{0};  // of an object that was read as far as needed
  bool damaged_{false};         // a container
  bool searching_{false};       // for an object, behind bytes that were none
  TimeGate gate_;
};

}  // namespace dampline::drivers
