// SPDX-License-Identifier: MIT
#include "app/run/provenance.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>
#include <sys/auxv.h>
#include <sys/stat.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cmath>
#include <ctime>
#include <span>
#include <vector>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/run/commit.hpp"
#include "app/text/format.hpp"
#include "drivers/bytes/byte_stream.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kMicrosecondNs = 1'000;

/// Digits of `text` from `at` on as a number; none where one is no digit.
std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
  int value = 0;
  const char* const end = text.data() + at + count;
  const auto [stopped, error] = std::from_chars(text.data() + at, end, value);
  if (error != std::errc{} || stopped != end || text[at] == '-') return std::nullopt;
  return value;
}

}  // namespace

InputFile describe_input(const std::filesystem::path& file, const std::string& role) {
  InputFile input{file.string(), role, 0, ""};
  sha256_ctx context{};
  sha256_init(&context);
  const auto bytes = drivers::read_parts(input.name, [&](std::span<const char> part) {
    sha256_update(&context, part.size(), reinterpret_cast<const std::uint8_t*>(part.data()));
    return true;
  });
  if (!bytes) throw RunError{bytes.error_text()};
  input.bytes = bytes.value();
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  for (const std::uint8_t byte : digest) input.sha256 += fmt::format("{:02x}", byte);
  return input;
}

InputFile describe_record(const std::string& path) {
  if (std::filesystem::is_regular_file(path)) return describe_input(path, "record");
  struct stat status {};
  if (path == "-" && ::fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode) &&
      ::lseek(STDIN_FILENO, 0, SEEK_CUR) == 0) {
    InputFile out = describe_input("/proc/self/fd/0", "record");
    out.name = path;
    return out;
  }
  const auto passed = drivers::ByteStream::passed_through(path);
  return passed ? InputFile{path, "record", passed->bytes, passed->sha256}
                : InputFile{path, "record", 0, ""};
}

std::string version() { return DAMPLINE_VERSION; }

std::string commit() { return kCommit; }

std::filesystem::path program_file() {
  // The kernel says it also where /proc is not mounted.
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what it gives
  const auto* const started = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  std::error_code error;
  return started == nullptr ? "" : std::filesystem::canonical(started, error);
}

std::string utc_text(std::int64_t time_ns) {
  const std::int64_t us = (time_ns - (time_ns < 0 ? kMicrosecondNs - 1 : 0)) / kMicrosecondNs;
  constexpr std::int64_t kSecondUs = kSecondNs / kMicrosecondNs;
  const std::time_t second = (us - (us < 0 ? kSecondUs - 1 : 0)) / kSecondUs;
  std::tm utc{};
  gmtime_r(&second, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", utc.tm_year + 1900,
                     utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                     us - second * kSecondUs);
}

std::optional<std::int64_t> utc_ns(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:dd.ddddddZ";
  if (text.size() != kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i)
    if (kForm[i] != 'd' && text[i] != kForm[i]) return std::nullopt;
  constexpr std::array<std::array<std::size_t, 2>, 7> kParts{
      {{0, 4}, {5, 2}, {8, 2}, {11, 2}, {14, 2}, {17, 2}, {20, 6}}};
  std::array<int, kParts.size()> part{};
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    const std::optional<int> value = digits(text, kParts[i][0], kParts[i][1]);
    if (!value) return std::nullopt;
    part[i] = *value;
  }
  std::tm utc{};
  utc.tm_year = part[0] - 1900;
  utc.tm_mon = part[1] - 1;
  utc.tm_mday = part[2];
  utc.tm_hour = part[3];
  utc.tm_min = part[4];
  utc.tm_sec = part[5];
  return std::int64_t{timegm(&utc)} * kSecondNs + part[6] * kMicrosecondNs;
}

RecordedSpan recorded_span(std::int64_t first_ns, std::int64_t last_ns) {
  constexpr std::int64_t kFrom1990Ns = 631'152'000 * kSecondNs;
  if (first_ns < kFrom1990Ns || last_ns < first_ns) return {};
  return {first_ns, last_ns};
}

RecordedSpan recorded_span_s(double first_s, double last_s) {
  constexpr double kMostS = 9.2e9;  // what 64 bits of nanoseconds hold
  if (!(std::fabs(first_s) < kMostS && std::fabs(last_s) < kMostS)) return {};
  const auto ns = [](double time_s) {
    return std::int64_t{std::llround(1e6 * time_s)} * kMicrosecondNs;
  };
  return recorded_span(ns(first_s), ns(last_s));
}

Origin origin_of(const Config& config, const std::vector<InputFile>& inputs,
                 const RecordedSpan& recorded) {
  Origin out;
  out.version = version();
  out.commit = commit();
  out.recorded = recorded;
  out.vehicle = config.record.vehicle;
  out.truck = config.record.truck;
  out.load = config.record.load;
  out.note = config.record.note;
  if (inputs.empty()) return out;
  out.source = inputs.front().name;
  out.sha256 = inputs.front().sha256;
  out.other_inputs.assign(inputs.begin() + 1, inputs.end());
  return out;
}

std::string write_run_toml(const Config& config, const std::vector<InputFile>& inputs) {
  std::string out =
      show_config(config) + fmt::format("\n[run]\nversion = {}\ncommit = {}\n",
                                        toml_string(version()), toml_string(commit()));
  for (const InputFile& input : inputs) {
    out += fmt::format("\n[[run.input]]\nname = {}\nrole = {}\n", toml_string(input.name),
                       toml_string(input.role));
    if (!input.sha256.empty())
      out += fmt::format("bytes = {}\nsha256 = {}\n", input.bytes, toml_string(input.sha256));
  }
  return out;
}

Provenance read_provenance(std::string_view text, const std::string& origin) {
  Provenance provenance;
  try {
    const toml::table file = toml::parse(text, origin);
    const auto run = file["run"];
    if (!run.is_table()) throw RunError{fmt::format("{}: no table [run]", origin)};
    provenance.version = run["version"].value_or(std::string{});
    if (const toml::array* list = run["input"].as_array()) {
      for (const toml::node& node : *list) {
        const toml::node_view<const toml::node> entry{node};
        provenance.inputs.push_back(
            {entry["name"].value_or(std::string{}), entry["role"].value_or(std::string{}),
             static_cast<std::uint64_t>(entry["bytes"].value_or(std::int64_t{0})),
             entry["sha256"].value_or(std::string{})});
      }
    }
  } catch (const toml::parse_error& error) {
    throw RunError{
        fmt::format("{}:{}: not TOML: {}", origin, error.source().begin.line, error.description())};
  }
  return provenance;
}

}  // namespace dampline::app
