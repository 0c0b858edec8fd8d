// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "dampline/can_frame.hpp"
#include "drivers/mdf/layout.hpp"
#include "drivers/mdf/records.hpp"

namespace dampline::drivers {

/// Records of CAN_DataFrame, CAN_RemoteFrame or CAN_ErrorFrame: where their fields are.
class MdfFrameGroup {
 public:
  /// Whether a group is one; others are of other buses, or of measured signals.
  [[nodiscard]] static bool is_one(const MdfGroup& group);
  /// Errors: a field is missing, lies outside the record, or is stored as nothing that is read
  /// here.
  [[nodiscard]] static Outcome<MdfFrameGroup> make(const MdfLayout& layout,
                                                   const MdfDataGroup& data_group,
                                                   std::size_t group);

  /// Sets all of the frame but interface_index, its time from the file's beginning, and the number
  /// of its channel. Null, or what is wrong with it.
  [[nodiscard]] const char* read(std::span<const char> record, CanFrame& frame,
                                 std::uint32_t& channel) noexcept;
  /// Of the data of variable length; empty: nothing is wrong.
  [[nodiscard]] std::string fault() const { return values_ ? values_->fault() : std::string{}; }

 private:
  struct Fields {
    const MdfChannel* time{nullptr};
    const MdfChannel* id{nullptr};
    const MdfChannel* extended{nullptr};
    const MdfChannel* code{nullptr};    // DLC
    const MdfChannel* length{nullptr};  // bytes
    const MdfChannel* data{nullptr};
    const MdfChannel* bus{nullptr};
    const MdfChannel* fd{nullptr};
    const MdfChannel* bit_rate{nullptr};
    const MdfChannel* error_state{nullptr};
  };
  [[nodiscard]] std::string check(const MdfGroup& group) const;
  [[nodiscard]] const char* read_time(std::span<const char> record, CanFrame& frame) noexcept;
  [[nodiscard]] const char* read_data(std::span<const char> record, CanFrame& frame) noexcept;

  Fields fields_;
  bool remote_{false};
  bool error_{false};
  std::uint32_t channel_{1};  // where no field says it
  std::uint64_t count_{0};    // of records that were read
  std::unique_ptr<MdfValues> values_;
};

}  // namespace dampline::drivers
