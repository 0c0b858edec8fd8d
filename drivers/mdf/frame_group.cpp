// SPDX-License-Identifier: MIT
#include "drivers/mdf/frame_group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "drivers/record/identifier.hpp"
#include "drivers/text/cursor.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

/// "CAN_DataFrame" of "CAN_DataFrame.ID" and of itself.
std::string_view structure_of(std::string_view name) { return name.substr(0, name.find('.')); }

bool is_structure(std::string_view name) {
  return name == "CAN_DataFrame" || name == "CAN_RemoteFrame" || name == "CAN_ErrorFrame";
}

std::string_view structure_of(const MdfGroup& group) {
  for (const MdfChannel& channel : group.channels)
    if (is_structure(structure_of(channel.name))) return structure_of(channel.name);
  return {};
}

/// The number at the end of "CAN3".
std::uint32_t number_of(std::string_view name) {
  std::uint32_t out = 1;
  const std::size_t last = name.find_last_not_of("0123456789");
  const std::string_view digits = name.substr(last == std::string_view::npos ? 0 : last + 1);
  std::from_chars(digits.data(), digits.data() + digits.size(), out);
  return out;
}

bool flag(const MdfChannel* channel, std::span<const char> record) noexcept {
  return channel != nullptr && channel->bits(record) != 0;
}

bool is_bytes(const MdfChannel& channel) {
  return channel.type == MdfChannel::Type::kFixed ||
         channel.type == MdfChannel::Type::kMaximumLength;
}

}  // namespace

bool MdfFrameGroup::is_one(const MdfGroup& group) { return !structure_of(group).empty(); }

Outcome<MdfFrameGroup> MdfFrameGroup::make(const MdfLayout& layout, const MdfDataGroup& data_group,
                                           std::size_t group) {
  const MdfGroup& records = data_group.groups[group];
  MdfFrameGroup out;
  const std::string_view structure = structure_of(records);
  out.remote_ = structure == "CAN_RemoteFrame";
  out.error_ = structure == "CAN_ErrorFrame";
  out.channel_ = number_of(records.name);
  const std::array<std::pair<std::string_view, const MdfChannel**>, 9> places{
      {{"ID", &out.fields_.id},
       {"IDE", &out.fields_.extended},
       {"DLC", &out.fields_.code},
       {"DataLength", &out.fields_.length},
       {"DataBytes", &out.fields_.data},
       {"BusChannel", &out.fields_.bus},
       {"EDL", &out.fields_.fd},
       {"BRS", &out.fields_.bit_rate},
       {"ESI", &out.fields_.error_state}}};
  for (const MdfChannel& channel : records.channels) {
    if (channel.is_time) out.fields_.time = &channel;
    const std::string_view name = channel.name;
    for (const auto& [field, place] : places)
      if (name.substr(name.rfind('.') + 1) == field) *place = &channel;
  }
  const auto refuse = [&](std::string_view what) {
    return Failure{Errc::kMalformed,
                   fmt::format("{}: the records {} {}", layout.name,
                               records.name.empty() ? structure : quote(records.name), what)};
  };
  if (const std::string wrong = out.check(records); !wrong.empty()) return refuse(wrong);
  if (out.fields_.data != nullptr && out.fields_.data->type == MdfChannel::Type::kVariable) {
    out.values_ = MdfValues::open(layout, data_group, out.fields_.data->signal_data);
    if (!out.values_) return refuse("have no signal data where DataBytes should be");
  }
  return out;
}

std::string MdfFrameGroup::check(const MdfGroup& group) const {
  if (group.remote_master) return "have their times in another group, which is not read";
  if (fields_.time == nullptr) return "have no channel of time in s";
  const bool counted = fields_.time->type == MdfChannel::Type::kVirtualMaster;
  if (!(counted || fields_.time->is_number(group.data_bytes)) || !fields_.time->linear)
    return "have times that are no little-endian numbers with a linear conversion";
  if (!error_ && fields_.id == nullptr) return "have no ID";
  for (const MdfChannel* field : {fields_.id, fields_.extended, fields_.code, fields_.length,
                                  fields_.bus, fields_.fd, fields_.bit_rate, fields_.error_state})
    if (field != nullptr &&
        (field->data_type != MdfChannel::kUnsigned || !field->is_number(group.data_bytes)))
      return fmt::format("have {} as something else than an unsigned little-endian number",
                         quote(field->name));
  if (error_ || remote_) return {};
  if (fields_.data == nullptr || (fields_.length == nullptr && fields_.code == nullptr))
    return "have no DataBytes, or neither DataLength nor DLC";
  const MdfChannel& data = *fields_.data;
  if (data.type == MdfChannel::Type::kVariable)
    return (data.bit_count == 32 || data.bit_count == 64) && data.bit_offset == 0 &&
                   data.byte_offset + std::uint64_t{data.bit_count / 8} <= group.data_bytes
               ? std::string{}
               : "have the place of DataBytes outside themselves";
  if (!is_bytes(data) || data.bit_offset != 0 || data.bit_count % 8 != 0 ||
      data.byte_offset + std::uint64_t{data.bit_count / 8} > group.data_bytes)
    return "have DataBytes outside themselves, or as no bytes";
  return {};
}

const char* MdfFrameGroup::read(std::span<const char> record, CanFrame& frame,
                                std::uint32_t& channel) noexcept {
  frame = {};
  ++count_;
  channel =
      fields_.bus == nullptr ? channel_ : static_cast<std::uint32_t>(fields_.bus->bits(record));
  if (const char* wrong = read_time(record, frame); wrong != nullptr) return wrong;
  frame.error = error_;
  frame.remote = remote_;
  if (error_) return nullptr;
  const auto id = static_cast<std::uint32_t>(fields_.id->bits(record));
  const bool marked = (id & kExtendedFlag) != 0 || (id & kExtendedMask) > kStandardMask;
  frame.extended = fields_.extended == nullptr ? marked : flag(fields_.extended, record);
  frame.id = id & kExtendedMask;
  if (!frame.extended && frame.id > kStandardMask) return "an identifier of more than 11 bits";
  frame.fd = flag(fields_.fd, record);
  if (frame.fd)
    frame.fd_flags = static_cast<std::uint8_t>((flag(fields_.bit_rate, record) ? 1U : 0U) |
                                               (flag(fields_.error_state, record) ? 2U : 0U));
  return read_data(record, frame);
}

const char* MdfFrameGroup::read_time(std::span<const char> record, CanFrame& frame) noexcept {
  constexpr double kMostS = 4e9;
  const MdfChannel& time = *fields_.time;
  const double time_s = time.type == MdfChannel::Type::kVirtualMaster
                            ? time.offset + time.factor * static_cast<double>(count_ - 1)
                            : time.number(record);
  if (!(time_s >= 0.0 && time_s < kMostS)) return "a time that is none";
  frame.time_ns = std::llround(1e9 * time_s);
  return nullptr;
}

const char* MdfFrameGroup::read_data(std::span<const char> record, CanFrame& frame) noexcept {
  constexpr const char* kNoData = "fewer bytes of data than it says";
  std::uint64_t length = 0;
  if (fields_.length != nullptr) {
    length = fields_.length->bits(record);
  } else if (fields_.code != nullptr) {
    length = length_of_code(
        static_cast<std::uint32_t>(std::min<std::uint64_t>(fields_.code->bits(record), 15)));
    if (!frame.fd) length = std::min<std::uint64_t>(length, 8);
  }
  if (length > frame.data.size()) return "more than 64 bytes of data";
  frame.length = static_cast<std::uint8_t>(length);
  if (frame.remote || fields_.data == nullptr) return nullptr;
  std::span<const char> data;
  if (values_) {
    std::uint64_t place = 0;
    std::memcpy(&place, record.data() + fields_.data->byte_offset, fields_.data->bit_count / 8);
    const auto value = values_->at(place);
    if (!value) return kNoData;
    data = *value;
  } else {
    data = record.subspan(fields_.data->byte_offset, fields_.data->bit_count / 8);
  }
  if (data.size() < length) return kNoData;
  std::memcpy(frame.data.data(), data.data(), length);
  return nullptr;
}

}  // namespace dampline::drivers
