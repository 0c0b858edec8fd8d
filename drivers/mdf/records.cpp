// SPDX-License-Identifier: MIT
#include "drivers/mdf/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

namespace dampline::drivers {
namespace {

constexpr std::size_t kLengthBytes = 4;

}  // namespace

MdfRecords::MdfRecords(const MdfLayout& layout, const MdfDataGroup& data_group,
                       std::vector<bool> wanted)
    : data_group_{data_group},
      wanted_{std::move(wanted)},
      counts_(data_group.groups.size()),
      data_{layout.file, data_group.data, !layout.finalised} {}

MdfRecords::Step MdfRecords::next() noexcept {
  const std::size_t id_bytes = data_group_.id_bytes;
  for (;;) {
    if (!data_.skip(std::exchange(pending_, 0))) return end(true);
    const auto beginning = data_.look(std::max<std::size_t>(id_bytes, 1));
    if (beginning.size() < std::max<std::size_t>(id_bytes, 1)) return end(!beginning.empty());
    std::uint64_t id = 0;
    std::memcpy(&id, beginning.data(), id_bytes);
    const auto group = group_of(id);
    if (!group) return fail(fmt::format("found a record of the unknown identifier {}", id));
    const MdfGroup& kind = data_group_.groups[*group];
    std::size_t before = id_bytes;
    std::uint64_t size = kind.data_bytes;
    if (!data_.is_values() && !kind.variable) size += kind.invalidation_bytes;
    if (kind.variable) {
      before += kLengthBytes;
      const auto head = data_.look(before);
      if (head.size() < before) return end(true);
      size = little<std::uint32_t>(head.data() + id_bytes);
    }
    if (before + size == 0) return fail("found records of no bytes");
    pending_ = before + size;
    if (!wanted_[*group]) continue;
    if (pending_ > MdfData::kLongest)
      return fail(fmt::format("found a record of {} bytes, expected at most {}", pending_,
                              MdfData::kLongest));
    const auto whole = data_.look(static_cast<std::size_t>(pending_));
    if (whole.size() < pending_) return end(true);
    group_ = *group;
    ++counts_[group_];
    record_ = whole.subspan(before);
    return Step::kRecord;
  }
}

std::optional<std::size_t> MdfRecords::group_of(std::uint64_t record_id) noexcept {
  const auto& groups = data_group_.groups;
  if (groups.empty()) return std::nullopt;
  if (data_group_.id_bytes == 0 || groups[group_].record_id == record_id) return group_;
  for (std::size_t i = 0; i < groups.size(); ++i)
    if (groups[i].record_id == record_id) return i;
  return std::nullopt;
}

bool MdfRecords::is_short() const noexcept {
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (wanted_[i] && counts_[i] < data_group_.groups[i].cycles) return true;
  return false;
}

MdfRecords::Step MdfRecords::end(bool inside) noexcept {
  if (!data_.fault().empty()) return fail(data_.fault());
  return inside || data_.is_cut_off() ? Step::kCut : Step::kEnd;
}

MdfRecords::Step MdfRecords::fail(std::string text) noexcept {
  fault_ = std::move(text);
  return Step::kFault;
}

std::unique_ptr<MdfValues> MdfValues::open(const MdfLayout& layout, const MdfDataGroup& data_group,
                                           MdfLink signal_data) {
  std::vector<bool> wanted;
  bool in_records = false;
  for (const MdfGroup& group : data_group.groups) {
    wanted.push_back(group.variable && group.at == signal_data);
    in_records = in_records || wanted.back();
  }
  if (in_records)
    return std::unique_ptr<MdfValues>{
        new MdfValues{layout, nullptr, data_group, std::move(wanted)}};
  const auto head = read_mdf_head(*layout.file, signal_data);
  if (signal_data != 0 && (!head || head->is("CG") || head->is("CN"))) return nullptr;
  auto own = std::make_unique<MdfDataGroup>();
  own->data = signal_data;
  own->groups.emplace_back().variable = true;
  const MdfDataGroup& alone = *own;
  return std::unique_ptr<MdfValues>{new MdfValues{layout, std::move(own), alone, {true}}};
}

MdfValues::MdfValues(const MdfLayout& layout, std::unique_ptr<MdfDataGroup> own,
                     const MdfDataGroup& data_group, std::vector<bool> wanted)
    : own_{std::move(own)},
      in_order_{layout.variable_in_order},
      records_{layout, data_group, std::move(wanted)} {}

std::optional<std::span<const char>> MdfValues::at(std::uint64_t place) noexcept {
  if (any_ && place < place_ && !in_order_) return std::nullopt;
  while (!any_ || in_order_ || place_ < place) {
    const std::uint64_t step = any_ ? kLengthBytes + records_.record().size() : 0;
    if (records_.next() != MdfRecords::Step::kRecord) return std::nullopt;
    place_ += step;
    any_ = true;
    if (in_order_) break;
  }
  if (!in_order_ && place_ != place) return std::nullopt;
  return records_.record();
}

}  // namespace dampline::drivers
