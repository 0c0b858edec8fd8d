// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string_view>

namespace dampline::drivers {

/// A format that is no record of frames or rows, beside those that RecordFormat names.
struct ForeignKind {
  std::string_view name;     ///< "a PDF document"
  std::string_view way_out;  ///< what to do, as a person or a command does it
};

/// What the beginning of a file shows it to be; nothing where it may be a record, or is not known.
[[nodiscard]] std::optional<ForeignKind> foreign_kind(std::string_view head);

}  // namespace dampline::drivers
