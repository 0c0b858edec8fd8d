// SPDX-License-Identifier: MIT
#include "drivers/mdf/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/mdf/frame_group.hpp"

namespace dampline::drivers {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool is_column(const MdfChannel& channel, const MdfGroup& group) {
  if (!channel.linear) return false;
  if (channel.type == MdfChannel::Type::kVirtualMaster) return true;
  const bool stored =
      channel.type == MdfChannel::Type::kFixed || channel.type == MdfChannel::Type::kMaster;
  return stored && channel.is_number(group.data_bytes);
}

bool has_columns(const MdfGroup& group) {
  return !group.variable && !group.remote_master && !MdfFrameGroup::is_one(group) &&
         std::any_of(group.channels.begin(), group.channels.end(), [&](const MdfChannel& channel) {
           return channel.type == MdfChannel::Type::kFixed && is_column(channel, group);
         });
}

bool is_invalid(const MdfChannel& channel, const MdfGroup& group, std::span<const char> record) {
  if (channel.invalid) return true;
  if (!channel.invalidation_bit) return false;
  const std::uint64_t place = group.data_bytes + std::uint64_t{*channel.invalidation_bit / 8};
  if (place >= record.size()) return false;
  const auto byte = static_cast<unsigned char>(record[static_cast<std::size_t>(place)]);
  return (byte >> (*channel.invalidation_bit % 8U) & 1U) != 0;
}

}  // namespace

bool mdf_holds_frames(const std::string& path) {
  const auto layout = read_mdf_layout(path);
  if (!layout) return true;
  bool rows = false;
  for (const MdfDataGroup& data_group : layout.value().data_groups)
    for (const MdfGroup& group : data_group.groups) {
      if (MdfFrameGroup::is_one(group)) return true;
      rows = rows || has_columns(group);
    }
  return !rows;
}

Outcome<std::unique_ptr<RecordedRows>> MdfReader::open(const RowFileConfig& config) {
  auto layout = read_mdf_layout(config.path);
  if (!layout) return layout.failure();
  std::unique_ptr<MdfReader> out{new MdfReader{config, std::move(layout.value())}};
  if (const auto ready = out->prepare(config); !ready) return ready.failure();
  return std::unique_ptr<RecordedRows>{std::move(out)};
}

Outcome<bool> MdfReader::prepare(const RowFileConfig& config) {
  const MdfDataGroup* place = nullptr;
  for (const MdfDataGroup& data_group : layout_.data_groups)
    for (const MdfGroup& group : data_group.groups)
      if (has_columns(group) && (group_ == nullptr || group.cycles > group_->cycles)) {
        place = &data_group;
        group_ = &group;
      }
  if (group_ == nullptr)
    return Failure{Errc::kMalformed,
                   fmt::format("{}: holds no channels of little-endian numbers, raw or with a "
                               "linear conversion",
                               layout_.name)};
  std::vector<bool> wanted;
  for (const MdfGroup& group : place->groups) wanted.push_back(&group == group_);
  records_ = std::make_unique<MdfRecords>(layout_, *place, std::move(wanted));
  for (const MdfChannel& channel : group_->channels) {
    if (!is_column(channel, *group_)) continue;
    columns_.push_back(&channel);
    header_.push_back(channel.is_time ? "time_s" : channel.name);
    units_.push_back(channel.is_time ? "s" : channel.unit);
  }
  return choose_columns(config, layout_.name);
}

std::optional<double> MdfReader::share_read() const noexcept {
  return std::min(1.0, static_cast<double>(records_->stored_bytes()) /
                           static_cast<double>(layout_.file->size()));
}

std::optional<std::int64_t> MdfReader::start_utc_ns() const noexcept {
  if (layout_.start_ns == 0 || layout_.local_time) return std::nullopt;
  return layout_.start_ns;
}

void MdfReader::take_record(std::span<double> row) noexcept {
  std::fill(row.begin(), row.end(), kNone);
  const auto record = records_->record();
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (place_of_[column] == kUnused) continue;
    const MdfChannel& channel = *columns_[column];
    double& value = row[place_of_[column]];
    if (channel.type == MdfChannel::Type::kVirtualMaster)
      value = channel.offset + channel.factor * static_cast<double>(row_);
    else if (!is_invalid(channel, *group_, record))
      value = channel.number(record);
  }
}

MdfReader::Step MdfReader::read_one(std::span<double> row) noexcept {
  switch (records_->next()) {
    case MdfRecords::Step::kRecord:
      return judge_record(row);
    case MdfRecords::Step::kCut:
      health_.truncated = true;
      break;
    case MdfRecords::Step::kEnd:
      health_.truncated = records_->is_short();
      break;
    case MdfRecords::Step::kFault:
      return stop(Errc::kMalformed, fmt::format("{}: {}", layout_.name, records_->fault()));
  }
  if (row_ > 0) return stop(Errc::kEndOfStream, {});
  return stop(Errc::kMalformed, fmt::format("{}: holds no whole record", layout_.name));
}

MdfReader::Step MdfReader::judge_record(std::span<double> row) noexcept {
  take_record(row);
  health_.line = ++row_;
  const std::string fault = check_time(row);
  if (fault.empty()) return Step::kRow;
  return bad_row(fmt::format("{}: record {}: {}", layout_.name, row_, fault));
}

}  // namespace dampline::drivers
