// SPDX-License-Identifier: MIT
#include "app/record/source_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "app/error.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/csv/reader.hpp"
#include "drivers/socketcan/link.hpp"

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
  if (!std::filesystem::exists(status))
    fail(path, fmt::format(
                   "no such file and no such CAN interface ({}); a source is an interface, a "
                   "candump log, a CSV file, a black box, or - for candump text on standard input",
                   drivers::links_text()));
  if (std::filesystem::is_directory(status))
    fail(path, "is a directory without a black box, expected a record");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) == 0)
    fail(path, "is empty");
}

/// A file of that name goes first: it can be moved away, an interface cannot.
bool is_interface(const std::string& path) {
  std::error_code error;
  return !std::filesystem::exists(path, error) && ::if_nametoindex(path.c_str()) != 0;
}

/// A line that begins like one of candump's: "(".
bool looks_like_candump(const std::string& path) {
  std::ifstream stream{path, std::ios::binary};
  std::array<char, 65536> head{};
  stream.read(head.data(), head.size());
  const std::string_view text{head.data(), static_cast<std::size_t>(stream.gcount())};
  return text.starts_with('(') || text.find("\n(") != std::string_view::npos;
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
  const auto header = drivers::CsvReader::header_of(path);
  if (!header.ok()) throw RunError{header.error_text()};
  const auto truck = missing(input, kTruckColumns, header.value());
  auto rig = missing(input, kRigColumns, header.value());
  if (input.sample_rate_is_set) std::erase(rig, input.header(Column::kTime));
  if (truck.empty()) return SourceKind::kTruckCsv;
  if (rig.empty()) return SourceKind::kRigCsv;
  fail(path,
       fmt::format("for a truck record the columns {} are missing, for a rig {}; found {}. [input."
                   "columns] maps other names; lines before the header begin with #",
                   fmt::join(truck, ", "), fmt::join(rig, ", "), fmt::join(header.value(), ", ")));
}

}  // namespace

SourceKind detect_source(const Config& config, const SourceOptions& source) {
  if (source.path == "-") return SourceKind::kCandump;
  if (is_interface(source.path)) return SourceKind::kInterface;
  if (drivers::is_blackbox(source.path)) return SourceKind::kBlackbox;
  check_exists(source.path);
  const std::string suffix = std::filesystem::path{source.path}.extension().string();
  if (suffix == ".log") return SourceKind::kCandump;
  const bool regular = std::filesystem::is_regular_file(source.path);
  if (suffix != ".csv" && (!regular || looks_like_candump(source.path)))
    return SourceKind::kCandump;
  return detect_columns(config.input, source.path);
}

}  // namespace dampline::app
