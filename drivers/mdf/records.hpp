// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/mdf/data.hpp"
#include "drivers/mdf/layout.hpp"

namespace dampline::drivers {

/// The records of a data group one after the other, of the groups that are wanted. Groups of
/// variable length give their values. Keeps references to the layout.
class MdfRecords {
 public:
  enum class Step : std::uint8_t {
    kRecord,
    kEnd,
    kCut,    ///< ends within a record
    kFault,  ///< fault() says why
  };
  /// `wanted` by the group's index.
  MdfRecords(const MdfLayout& layout, const MdfDataGroup& data_group, std::vector<bool> wanted);
  /// Drops the record before.
  [[nodiscard]] Step next() noexcept;
  [[nodiscard]] std::size_t group() const noexcept { return group_; }
  /// With its bits of invalidation, where the data have them. Good until the next call of next().
  [[nodiscard]] std::span<const char> record() const noexcept { return record_; }
  [[nodiscard]] const std::string& fault() const noexcept { return fault_; }
  [[nodiscard]] std::uint64_t stored_bytes() const noexcept { return data_.stored_bytes(); }
  /// At the end: a wanted group has fewer records than the file says.
  [[nodiscard]] bool is_short() const noexcept;

 private:
  [[nodiscard]] Step end(bool inside) noexcept;
  Step fail(std::string text) noexcept;
  [[nodiscard]] std::optional<std::size_t> group_of(std::uint64_t record_id) noexcept;

  const MdfDataGroup& data_group_;
  std::vector<bool> wanted_;
  std::vector<std::uint64_t> counts_;
  MdfData data_;
  std::size_t group_{0};
  std::uint64_t pending_{0};  // bytes of the record that is shown
  std::span<const char> record_;
  std::string fault_;
};

/// The values of a channel of variable length, by their place in the signal data or one by one.
class MdfValues {
 public:
  /// From a block of signal data, or from the records of a group of the same data group. Nothing:
  /// the link leads to neither.
  [[nodiscard]] static std::unique_ptr<MdfValues> open(const MdfLayout& layout,
                                                       const MdfDataGroup& data_group,
                                                       MdfLink signal_data);
  /// Places must not go back. Nothing: there is no value, or fault() says why.
  [[nodiscard]] std::optional<std::span<const char>> at(std::uint64_t place) noexcept;
  [[nodiscard]] const std::string& fault() const noexcept { return records_.fault(); }

 private:
  MdfValues(const MdfLayout& layout, std::unique_ptr<MdfDataGroup> own,
            const MdfDataGroup& data_group, std::vector<bool> wanted);
  std::unique_ptr<MdfDataGroup> own_;
  bool in_order_;
  MdfRecords records_;
  bool any_{false};
  std::uint64_t place_{0};  // of the value that is shown
};

}  // namespace dampline::drivers
