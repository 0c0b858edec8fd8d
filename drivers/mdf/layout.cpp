// SPDX-License-Identifier: MIT
#include "drivers/mdf/layout.hpp"

#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include "drivers/bytes/spool.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kIdentification = 64;
constexpr std::size_t kMostBlocks = 65536;
constexpr int kDeepest = 8;  // structures in structures

// What a file that was not finalised still lacks.
constexpr unsigned kLacksCycles = 0x01;
constexpr unsigned kLacksReductions = 0x02 | 0x08;
constexpr unsigned kLacksLastLength = 0x04;
constexpr unsigned kLacksVariableBytes = 0x20;
constexpr unsigned kLacksVariablePlaces = 0x40;
constexpr unsigned kCanBeRead =
    kLacksCycles | kLacksReductions | kLacksLastLength | kLacksVariableBytes | kLacksVariablePlaces;

/// Walks along the links of the description.
class Walk {
 public:
  explicit Walk(MdfLayout& out) : out_{out} {}

  [[nodiscard]] bool header() {
    const auto block = take(kIdentification, "HD", 6, 32);
    if (!block) return false;
    const auto start_ns = block->get<std::uint64_t>(0);
    constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / 2;
    out_.start_ns = start_ns > kMost ? 0 : static_cast<std::int64_t>(start_ns);
    out_.local_time = (block->get<std::uint8_t>(12) & 1U) != 0;
    for (MdfLink at = block->links[0]; at != 0;) {
      const auto next = data_group(at);
      if (!next) return false;
      at = *next;
    }
    return true;
  }
  [[nodiscard]] Failure failure() const {
    return {Errc::kMalformed, fmt::format("{}: at byte {}: {}", out_.name, wrong_at_, wrong_)};
  }

 private:
  std::optional<MdfBlock> take(MdfLink at, const char* name, std::size_t links, std::size_t bytes) {
    wrong_at_ = at;
    if (!seen_.insert(at).second) {
      wrong_ = fmt::format("its links lead in a circle to this ##{}", name);
      return std::nullopt;
    }
    if (seen_.size() > kMostBlocks) {
      wrong_ = fmt::format("found more than {} blocks that describe channels", kMostBlocks);
      return std::nullopt;
    }
    auto block = read_mdf_block(*out_.file, at, name, links, bytes);
    if (!block) wrong_ = fmt::format("expected a block ##{}: the file is damaged or cut off", name);
    return block;
  }

  std::optional<MdfLink> data_group(MdfLink at) {
    const auto block = take(at, "DG", 4, 1);
    if (!block) return std::nullopt;
    MdfDataGroup group;
    group.id_bytes = block->get<std::uint8_t>(0);
    group.data = block->links[2];
    if (group.id_bytes > 8 || (group.id_bytes & (group.id_bytes - 1U)) != 0) {
      wrong_ = fmt::format("found record identifiers of {} bytes, expected 0, 1, 2, 4 or 8",
                           group.id_bytes);
      return std::nullopt;
    }
    for (MdfLink next = block->links[1]; next != 0;) {
      const auto behind = channel_group(next, group);
      if (!behind) return std::nullopt;
      next = *behind;
    }
    wrong_at_ = at;
    if (group.id_bytes == 0 && group.groups.size() > 1) {
      wrong_ = fmt::format("found {} groups of records without identifiers, expected one",
                           group.groups.size());
      return std::nullopt;
    }
    out_.data_groups.push_back(std::move(group));
    return block->links[0];
  }

  std::optional<MdfLink> channel_group(MdfLink at, MdfDataGroup& data_group) {
    const auto block = take(at, "CG", 6, 32);
    if (!block) return std::nullopt;
    MdfGroup group;
    group.at = at;
    group.name = read_mdf_text(*out_.file, block->links[2]);
    group.record_id = block->get<std::uint64_t>(0);
    group.cycles = out_.finalised ? block->get<std::uint64_t>(8) : 0;
    const auto flags = block->get<std::uint16_t>(16);
    group.variable = (flags & 0x01U) != 0;
    group.remote_master = (flags & 0x08U) != 0;
    group.data_bytes = block->get<std::uint32_t>(24);
    group.invalidation_bytes = block->get<std::uint32_t>(28);
    if (!channels(block->links[1], 0, group)) return std::nullopt;
    data_group.groups.push_back(std::move(group));
    return block->links[0];
  }

  // NOLINTNEXTLINE(misc-no-recursion) at most kDeepest
  bool channels(MdfLink at, int depth, MdfGroup& group) {
    while (at != 0) {
      const auto block = take(at, "CN", 8, 24);
      if (!block) return false;
      group.channels.push_back(channel(*block));
      const MdfLink part = block->links[1];
      const auto head = part == 0 ? std::nullopt : read_mdf_head(*out_.file, part);
      if (head && head->is("CN")) {
        if (depth == kDeepest) {
          wrong_ = fmt::format("found structures more than {} deep", kDeepest);
          return false;
        }
        if (!channels(part, depth + 1, group)) return false;
      } else if (part != 0) {
        group.channels.pop_back();  // an array
      }
      at = block->links[0];
    }
    return true;
  }

  [[nodiscard]] MdfChannel channel(const MdfBlock& block) const {
    MdfChannel out;
    out.name = read_mdf_text(*out_.file, block.links[2]);
    out.unit = read_mdf_text(*out_.file, block.links[6]);
    const auto type = block.get<std::uint8_t>(0);
    out.type = type > 6 ? MdfChannel::Type::kVirtual : static_cast<MdfChannel::Type>(type);
    out.is_time =
        (out.type == MdfChannel::Type::kMaster || out.type == MdfChannel::Type::kVirtualMaster) &&
        block.get<std::uint8_t>(1) == 1;
    out.data_type = block.get<std::uint8_t>(2);
    out.bit_offset = block.get<std::uint8_t>(3);
    out.byte_offset = block.get<std::uint32_t>(4);
    out.bit_count = block.get<std::uint32_t>(8);
    const auto flags = block.get<std::uint32_t>(12);
    out.invalid = (flags & 1U) != 0;
    if ((flags & 2U) != 0) out.invalidation_bit = block.get<std::uint32_t>(16);
    out.signal_data = block.links[5];
    if (block.links[4] != 0) convert(block.links[4], out);
    return out;
  }

  void convert(MdfLink at, MdfChannel& out) const {
    constexpr std::uint8_t kLinear = 1;
    const auto block = read_mdf_block(*out_.file, at, "CC", 4, 24);
    const auto type = block ? block->get<std::uint8_t>(0) : std::uint8_t{255};
    out.linear = type == 0 || (type == kLinear && block->data_bytes >= 40);
    if (out.unit.empty() && block) out.unit = read_mdf_text(*out_.file, block->links[1]);
    if (type != kLinear || !out.linear) return;
    out.offset = block->get<double>(24);
    out.factor = block->get<double>(32);
  }

  MdfLayout& out_;
  std::set<MdfLink> seen_;
  MdfLink wrong_at_{0};
  std::string wrong_;
};

std::size_t bytes_of(const MdfChannel& channel) noexcept {
  return (std::size_t{channel.bit_offset} + channel.bit_count + 7) / 8;
}

/// Whether what was not finalised can be read all the same; else why not.
std::string_view take_identification(std::span<const char> bytes, MdfLayout& out) noexcept {
  const std::string_view text{bytes.data(), bytes.size()};
  if (text.size() < kIdentification) return "ends within its first 64 bytes";
  if (little<std::uint16_t>(bytes.data() + 28) >= 500 ||
      little<std::uint16_t>(bytes.data() + 28) < 400)
    return "is no MDF file of version 4";
  out.finalised = !text.starts_with("UnFinMF ");
  if (out.finalised) return {};
  const unsigned lacks = little<std::uint16_t>(bytes.data() + 60);
  out.variable_in_order = (lacks & kLacksVariablePlaces) != 0;
  if ((lacks & ~kCanBeRead) != 0 || little<std::uint16_t>(bytes.data() + 62) != 0)
    return "was not finalised and lacks lists of its data; expected it finalised by the program of "
           "its logger";
  return {};
}

}  // namespace

bool MdfChannel::is_number(std::uint64_t data_bytes) const noexcept {
  if (type == Type::kVirtualMaster || type == Type::kVirtual) return false;
  const bool whole = data_type == kUnsigned || data_type == kSigned;
  const bool real = data_type == kReal && bit_offset == 0 && (bit_count == 32 || bit_count == 64);
  return (whole || real) && bit_offset < 8 && bit_count >= 1 && bytes_of(*this) <= 8 &&
         byte_offset + std::uint64_t{bytes_of(*this)} <= data_bytes;
}

std::uint64_t MdfChannel::bits(std::span<const char> record) const noexcept {
  std::uint64_t raw = 0;
  std::memcpy(&raw, record.data() + byte_offset, bytes_of(*this));
  raw >>= bit_offset;
  return bit_count < 64 ? raw & ((std::uint64_t{1} << bit_count) - 1) : raw;
}

double MdfChannel::number(std::span<const char> record) const noexcept {
  const std::uint64_t raw = bits(record);
  if (data_type == kReal && bit_count == 32)
    return offset + factor * static_cast<double>(little<float>(record.data() + byte_offset));
  if (data_type == kReal) return offset + factor * little<double>(record.data() + byte_offset);
  if (data_type == kUnsigned) return offset + factor * static_cast<double>(raw);
  const unsigned unused = 64U - bit_count;
  return offset + factor * static_cast<double>(static_cast<std::int64_t>(raw << unused) >> unused);
}

Outcome<MdfLayout> read_mdf_layout(const std::string& path) {
  const auto spool = spooled(path);
  if (!spool) return spool.failure();
  auto file = RandomFile::open(spool.value());
  if (!file) return file.failure();
  MdfLayout out;
  out.file = std::move(file.value());
  out.name = path == "-" ? "standard input" : path;
  std::array<char, kIdentification> bytes{};
  const std::size_t count = out.file->read(0, bytes);
  if (const auto wrong = take_identification(std::span{bytes}.first(count), out); !wrong.empty())
    return Failure{Errc::kMalformed, fmt::format("{}: {}", out.name, wrong)};
  Walk walk{out};
  if (!walk.header()) return walk.failure();
  return out;
}

}  // namespace dampline::drivers
