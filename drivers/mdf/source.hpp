// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/mdf/frame_group.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/record/time_gate.hpp"

namespace dampline::drivers {

/// ASAM MDF4 logs of CAN buses as a source of frames, as CANedge, Vector and others write them:
/// CAN_DataFrame, CAN_RemoteFrame and CAN_ErrorFrame, sorted or not, their bytes fixed or of
/// variable length, data plain, in lists, deflated, transposed. Groups with data of their own are
/// merged by time. Times are the file's start plus the channel of time, in s with a linear
/// conversion. In constant memory. A file that was not finalised is read where no list of its data
/// is missing. Not read: big-endian fields, times in another group, attachments, other buses.
/// Damage is an error with its byte; a frame that makes no sense is one, too, or is counted with
/// skip_bad_lines. A file that ends within its data, or holds fewer records than it says, sets
/// truncated. Written by the format's description.
class MdfSource final : public RecordedFrames {
 public:
  static Outcome<std::unique_ptr<RecordedFrames>> open(const FrameFileConfig& config);
  [[nodiscard]] std::optional<double> share_read() const noexcept override;
  [[nodiscard]] RecordClock clock() const noexcept override;

 private:
  /// The frames of one data group, the next of them ready.
  struct Strand {
    explicit Strand(MdfRecords reader) : records{std::move(reader)} {}
    MdfRecords records;
    std::vector<std::optional<MdfFrameGroup>> groups;  // by index; of those that are read
    bool ready{false};
    bool ended{false};
    CanFrame frame;
    std::uint32_t channel{0};
  };
  MdfSource(const FrameFileConfig& config, MdfLayout layout);
  [[nodiscard]] Outcome<bool> prepare();
  [[nodiscard]] Step read_one(CanFrame& frame) noexcept override;
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override {
    return true;
  }
  [[nodiscard]] bool fill(Strand& strand) noexcept;
  [[nodiscard]] bool take_record(Strand& strand) noexcept;
  [[nodiscard]] Strand* earliest() noexcept;
  [[nodiscard]] bool deliver(Strand& strand, CanFrame& frame) noexcept;
  bool bad_frame(const char* what) noexcept;
  void stop_at(const std::string& fault) noexcept;

  MdfLayout layout_;
  std::vector<Strand> strands_;
  std::uint64_t records_{0};
  TimeGate gate_;
};

}  // namespace dampline::drivers
