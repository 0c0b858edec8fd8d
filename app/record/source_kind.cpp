// SPDX-License-Identifier: MIT
#include "app/record/source_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "app/error.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/record/format.hpp"
#include "drivers/record/rows.hpp"
#include "drivers/socketcan/link.hpp"
#include "drivers/text/kind.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

namespace {

constexpr std::array kTruckColumns{Column::kTime, Column::kFrameAccel, Column::kWheelset1Accel,
                                   Column::kWheelset2Accel};
constexpr std::array kRigColumns{Column::kTime, Column::kDeflection, Column::kForce};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw RunError{fmt::format("{}: {}", path, what)};
}

void check_exists(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none)
    fail(path, "cannot be read: " + error.message());
  if (!std::filesystem::exists(status))
    fail(path,
         fmt::format("no such file and no such CAN interface ({}); a source is an interface, a "
                     "candump log, a CSV file or another record, a black box, or - for standard "
                     "input",
                     drivers::links_text()));
  if (std::filesystem::is_directory(status) &&
      std::filesystem::exists(std::filesystem::path{path} / "run.toml"))
    fail(path, "is a run directory, expected a record; dampline report draws its page again");
  if (std::filesystem::is_directory(status))
    fail(path, "is a directory without a black box, expected a record");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) == 0)
    fail(path, "is empty");
}

/// A file of that name goes first: it can be moved away, an interface cannot.
bool is_interface(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) return false;
  if (::if_nametoindex(path.c_str()) != 0) return true;
  if (errno != ENODEV && errno != ENXIO)
    fail(path, fmt::format("is no file, and the network interfaces cannot be read: {}",
                           std::generic_category().message(errno)));
  return false;
}

/// Text or bytes of a kind that is no record.
void refuse_foreign(const std::string& path) {
  const auto beginning = drivers::read_head(path);
  if (!beginning) return;
  const std::string_view head = beginning.value();
  const auto kind = drivers::foreign_kind(head);
  if (!kind) return;
  fail(path,
       fmt::format("is {}, beginning {}, expected a record (dampline identify --help names "
                   "its formats); the way out: {}",
                   kind->name, drivers::quote(head.substr(0, head.find('\n'))), kind->way_out));
}

std::vector<std::string> missing(const InputConfig& input, std::span<const Column> wanted,
                                 const std::vector<std::string>& header) {
  std::vector<std::string> names;
  for (const Column column : wanted) {
    const std::string name = input.header(column);
    if (std::find(header.begin(), header.end(), name) == header.end()) names.push_back(name);
  }
  return names;
}

SourceKind detect_columns(const InputConfig& input, const std::string& path) {
  const auto header = drivers::header_of(path);
  if (!header.ok()) throw RunError{header.error_text()};
  const auto truck = missing(input, kTruckColumns, header.value());
  auto rig = missing(input, kRigColumns, header.value());
  if (input.sample_rate_is_set) std::erase(rig, input.header(Column::kTime));
  if (truck.empty()) return SourceKind::kTruckRows;
  if (rig.empty()) return SourceKind::kRigRows;
  fail(path,
       fmt::format("for a truck record the columns {} are missing, for a rig {}; found {}. [input."
                   "columns] maps other names; lines before the header begin with #",
                   fmt::join(truck, ", "), fmt::join(rig, ", "),
                   drivers::list_names(header.value())));
}

}  // namespace

std::optional<SourceKind> detect_frames(const SourceOptions& source) {
  const bool piped = source.path == "-";
  if (!piped) {
    if (is_interface(source.path)) return SourceKind::kInterface;
    if (drivers::is_blackbox(source.path)) return SourceKind::kBlackbox;
    check_exists(source.path);
  }
  const auto format = drivers::detect_format(source.path);
  if (!format) throw RunError{format.error_text()};
  if (holds_frames(format.value())) return SourceKind::kFrames;
  if (const std::string_view way_out = drivers::way_out_of(format.value()); !way_out.empty())
    fail(source.path,
         fmt::format("is {}, which is not read: {}", name_of(format.value()), way_out));
  refuse_foreign(source.path);
  // What is no text is said by who expects frames, unless the name says rows.
  const std::string suffix = std::filesystem::path{source.path}.extension().string();
  const bool text = holds_rows(format.value());
  if (suffix == ".log" || (!text && suffix != ".csv")) return SourceKind::kFrames;
  return std::nullopt;
}

SourceKind detect_source(const Config& config, const SourceOptions& source) {
  if (const auto frames = detect_frames(source)) return *frames;
  return detect_columns(config.input, source.path);
}

}  // namespace dampline::app
