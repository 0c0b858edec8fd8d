// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/bytes/file_range.hpp"
#include "drivers/bytes/little_endian.hpp"

namespace dampline::drivers {

/// Offset of a block in its file; 0: none.
using MdfLink = std::uint64_t;

/// The head of a block: which it is and how far it goes. Links and data stand behind it.
struct MdfHead {
  static constexpr std::size_t kBytes = 24;

  MdfLink at{0};
  std::array<char, 2> id{};
  std::uint64_t length{0};  ///< with this head; may reach beyond the file's end
  std::uint64_t links{0};
  [[nodiscard]] bool is(std::string_view name) const noexcept {
    return name == std::string_view{id.data(), id.size()};
  }
  [[nodiscard]] MdfLink data_at() const noexcept { return at + kBytes + 8 * links; }
  [[nodiscard]] std::uint64_t data_bytes() const noexcept { return length - kBytes - 8 * links; }
};

/// Nothing: no block begins there, or its links do not fit into the file.
[[nodiscard]] std::optional<MdfHead> read_mdf_head(const RandomFile& file, MdfLink at) noexcept;

/// Link `i` of a block; 0 where it has fewer.
[[nodiscard]] MdfLink read_mdf_link(const RandomFile& file, const MdfHead& head,
                                    std::uint64_t i) noexcept;

/// A small block as a whole, or as much of it as anything here needs.
struct MdfBlock {
  static constexpr std::size_t kLinks = 8;
  static constexpr std::size_t kData = 256;

  MdfHead head;
  std::array<MdfLink, kLinks> links{};  ///< those that it lacks are 0
  std::array<char, kData> data{};
  std::size_t data_bytes{0};  ///< of `data`
  /// Precondition: data_bytes covers it.
  template <class T>
  [[nodiscard]] T get(std::size_t offset) const noexcept {
    return little<T>(data.data() + offset);
  }
};

/// Nothing: it is no block of that name within the file with at least so many links and bytes.
[[nodiscard]] std::optional<MdfBlock> read_mdf_block(const RandomFile& file, MdfLink at,
                                                     std::string_view name, std::size_t links,
                                                     std::size_t data_bytes) noexcept;

/// Text of a TX block, 256 bytes of it at most; "": there is none.
[[nodiscard]] std::string read_mdf_text(const RandomFile& file, MdfLink at);

}  // namespace dampline::drivers
