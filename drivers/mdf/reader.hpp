// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/mdf/layout.hpp"
#include "drivers/mdf/records.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::drivers {

/// Whether a file has records of CAN frames, or its description cannot be read: then who reads
/// frames says why.
[[nodiscard]] bool mdf_holds_frames(const std::string& path);

/// MDF4 of measured signals as a source of rows: of the groups with numbers the one with the most
/// records. Its channels are the columns, called as in the file; the channel of time in s is
/// "time_s". Little-endian whole numbers and real ones of 4 or 8 bytes, raw or with a linear
/// conversion; what a record marks as invalid is no number. Other channels, and other groups, which
/// have times of their own, are left out. In constant memory. Written by the format's description.
class MdfReader final : public RecordedRows {
 public:
  static Outcome<std::unique_ptr<RecordedRows>> open(const RowFileConfig& config);
  [[nodiscard]] std::optional<double> share_read() const noexcept override;
  [[nodiscard]] std::optional<std::int64_t> start_utc_ns() const noexcept override;

 private:
  MdfReader(const RowFileConfig& config, MdfLayout layout)
      : RecordedRows{config}, layout_{std::move(layout)} {}
  [[nodiscard]] Outcome<bool> prepare(const RowFileConfig& config);
  [[nodiscard]] Step read_one(std::span<double> row) noexcept override;
  void take_record(std::span<double> row) noexcept;
  Step judge_record(std::span<double> row) noexcept;

  MdfLayout layout_;
  const MdfGroup* group_{nullptr};
  std::vector<const MdfChannel*> columns_;  // of the header
  std::unique_ptr<MdfRecords> records_;
  std::uint64_t row_{0};
};

}  // namespace dampline::drivers
