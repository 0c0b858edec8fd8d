// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/mdf/block.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// One channel of a record, as the file describes it.
struct MdfChannel {
  enum class Type : std::uint8_t {
    kFixed,
    kVariable,  ///< the record has the place of the value in signal data
    kMaster,
    kVirtualMaster,  ///< counts the records
    kSync,
    kMaximumLength,
    kVirtual,
  };
  /// Of the file; others than these are only known by their number.
  static constexpr std::uint8_t kUnsigned = 0;
  static constexpr std::uint8_t kSigned = 2;
  static constexpr std::uint8_t kReal = 4;
  static constexpr std::uint8_t kBytes = 10;

  std::string name;
  std::string unit;
  Type type{Type::kFixed};
  bool is_time{false};  ///< a master whose values are s
  std::uint8_t data_type{kUnsigned};
  std::uint8_t bit_offset{0};
  std::uint32_t byte_offset{0};
  std::uint32_t bit_count{0};
  std::optional<std::uint32_t> invalidation_bit;
  bool invalid{false};  ///< throughout
  bool linear{true};    ///< value = offset + factor * raw; else the conversion is another one
  double factor{1.0};
  double offset{0.0};
  MdfLink signal_data{0};

  /// A number that number() reads, within so many bytes.
  [[nodiscard]] bool is_number(std::uint64_t data_bytes) const noexcept;
  /// Its bits as a whole number. Precondition: is_number() for the record's bytes.
  [[nodiscard]] std::uint64_t bits(std::span<const char> record) const noexcept;
  /// Converted. Preconditions: is_number() for the record's bytes, linear.
  [[nodiscard]] double number(std::span<const char> record) const noexcept;
};

/// Records of one kind.
struct MdfGroup {
  MdfLink at{0};
  std::string name;  ///< of the acquisition; often empty
  std::uint64_t record_id{0};
  std::uint64_t cycles{0};  ///< records; 0 in a file that was not finalised
  bool variable{false};     ///< its records are values of a channel of variable length
  bool remote_master{false};
  std::uint32_t data_bytes{0};
  std::uint32_t invalidation_bytes{0};
  std::vector<MdfChannel> channels;  ///< those of structures, too
};

/// Groups whose records lie in the same data, sorted (one group) or not.
struct MdfDataGroup {
  std::uint8_t id_bytes{0};  ///< before each record
  MdfLink data{0};
  std::vector<MdfGroup> groups;
};

/// What an MDF4 file holds.
struct MdfLayout {
  std::shared_ptr<RandomFile> file;
  std::string name;  ///< as errors call it
  std::int64_t start_ns{0};
  bool local_time{false};         ///< of a zone that is not told
  bool finalised{true};           ///< else counts are not set, and the last data go to the end
  bool variable_in_order{false};  ///< places of values are not set: they come one by one
  std::vector<MdfDataGroup> data_groups;
};

/// Reads the description; of the data nothing. Every link is checked, and circles of them are
/// refused. A pipe or a compressed file is copied (spooled()). Errors name the byte.
[[nodiscard]] Outcome<MdfLayout> read_mdf_layout(const std::string& path);

}  // namespace dampline::drivers
