// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "drivers/outcome.hpp"

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

/// What is kept of the files that are complete.
struct Retention {
  std::uint64_t keep_bytes{0};  ///< of all files together; 0: no limit
  std::int64_t keep_ns{0};      ///< age of a file's newest record; 0: no limit
};

/// The complete files of a black box, oldest first. Knows the black box's own files only; others
/// in the directory are never touched.
class BlackboxShelf {
 public:
  /// Looks at what is there and where to go on.
  static Outcome<BlackboxShelf> scan(const std::filesystem::path& directory);

  [[nodiscard]] std::uint32_t next_number() const noexcept { return next_number_; }
  [[nodiscard]] std::uint64_t next_sequence() const noexcept { return next_sequence_; }
  void add(std::uint32_t number, std::uint64_t bytes, std::int64_t created_ns);
  /// Removes the oldest files until the limits hold, counting a current file of `current_bytes`
  /// that began at `current_created_ns`. One that cannot be removed is not tried again. Gives how
  /// many went.
  std::uint64_t trim(int directory, const Retention& retention, std::uint64_t current_bytes,
                     std::int64_t current_created_ns, std::int64_t now_ns) noexcept;
  /// False: there is no complete file, or it stays.
  bool remove_oldest(int directory) noexcept;

 private:
  struct Kept {
    std::uint32_t number{0};
    std::uint64_t bytes{0};
    std::int64_t created_ns{0};
  };
  [[nodiscard]] bool oldest_is_due(const Retention& retention, std::uint64_t current_bytes,
                                   std::int64_t current_created_ns,
                                   std::int64_t now_ns) const noexcept;

  std::vector<Kept> files_;
  std::uint64_t bytes_{0};
  std::uint32_t next_number_{1};
  std::uint64_t next_sequence_{0};
};

}  // namespace dampline::drivers
