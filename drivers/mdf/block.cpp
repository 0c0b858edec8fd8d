// SPDX-License-Identifier: MIT
#include "drivers/mdf/block.hpp"

#include <algorithm>
#include <span>

namespace dampline::drivers {

std::optional<MdfHead> read_mdf_head(const RandomFile& file, MdfLink at) noexcept {
  std::array<char, MdfHead::kBytes> bytes{};
  if (at > file.size() || file.read(at, bytes) < bytes.size()) return std::nullopt;
  if (bytes[0] != '#' || bytes[1] != '#') return std::nullopt;
  const MdfHead out{at,
                    {bytes[2], bytes[3]},
                    little<std::uint64_t>(bytes.data() + 8),
                    little<std::uint64_t>(bytes.data() + 16)};
  const std::uint64_t most_links = (file.size() - at - MdfHead::kBytes) / 8;
  if (out.links > most_links || out.length < MdfHead::kBytes + 8 * out.links) return std::nullopt;
  return out;
}

MdfLink read_mdf_link(const RandomFile& file, const MdfHead& head, std::uint64_t i) noexcept {
  std::array<char, 8> bytes{};
  if (i >= head.links || file.read(head.at + MdfHead::kBytes + 8 * i, bytes) < bytes.size())
    return 0;
  return little<MdfLink>(bytes.data());
}

std::optional<MdfBlock> read_mdf_block(const RandomFile& file, MdfLink at, std::string_view name,
                                       std::size_t links, std::size_t data_bytes) noexcept {
  const auto head = read_mdf_head(file, at);
  if (!head || !head->is(name) || head->links < links || head->data_bytes() < data_bytes)
    return std::nullopt;
  MdfBlock out;
  out.head = *head;
  std::array<char, 8 * MdfBlock::kLinks> bytes{};
  const std::size_t known = std::min<std::uint64_t>(head->links, MdfBlock::kLinks);
  if (file.read(at + MdfHead::kBytes, std::span{bytes}.first(8 * known)) < 8 * known)
    return std::nullopt;
  for (std::size_t i = 0; i < known; ++i) out.links[i] = little<MdfLink>(bytes.data() + 8 * i);
  const std::size_t wanted = std::min<std::uint64_t>(head->data_bytes(), MdfBlock::kData);
  out.data_bytes = file.read(head->data_at(), std::span{out.data}.first(wanted));
  if (out.data_bytes < data_bytes) return std::nullopt;
  return out;
}

std::string read_mdf_text(const RandomFile& file, MdfLink at) {
  if (at == 0) return {};
  const auto block = read_mdf_block(file, at, "TX", 0, 0);
  if (!block) return {};
  const std::string_view text{block->data.data(), block->data_bytes};
  return std::string{text.substr(0, text.find('\0'))};
}

}  // namespace dampline::drivers
