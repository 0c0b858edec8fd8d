// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace dampline::drivers {

inline constexpr std::string_view kBlackboxLock = "blackbox.lock";

/// "blackbox-000001.dbb"; more digits where the number has them.
[[nodiscard]] std::string blackbox_file_name(std::uint32_t number);
/// Nothing for any other name.
[[nodiscard]] std::optional<std::uint32_t> blackbox_file_number(std::string_view name) noexcept;

struct BlackboxEntry {
  std::uint32_t number{0};
  std::uint64_t bytes{0};
  std::filesystem::path path;
};

/// The black box files of a directory by their numbers. Others are passed over.
[[nodiscard]] std::vector<BlackboxEntry> list_blackbox(const std::filesystem::path& directory,
                                                       std::error_code& error);

/// A directory that a black box was written to, or one of its files.
[[nodiscard]] bool is_blackbox(const std::filesystem::path& path);

}  // namespace dampline::drivers
