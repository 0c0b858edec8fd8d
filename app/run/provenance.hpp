// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

struct Config;

/// A file that went into a run.
struct InputFile {
  std::string name;  ///< as given; "-" is standard input, which has no size and no checksum
  std::string role;  ///< "record" or "dbc"
  std::uint64_t bytes{0};
  std::string sha256;  ///< 64 hexadecimal digits, as sha256sum prints them; empty: not known
};

/// Reads the file through once. Throws RunError when it cannot be read.
[[nodiscard]] InputFile describe_input(const std::filesystem::path& file, const std::string& role);
/// The same; of what is no regular file the name alone.
[[nodiscard]] InputFile describe_record(const std::string& path);

/// The program that runs, as the kernel started it: links followed. Empty: not known.
[[nodiscard]] std::filesystem::path program_file();

/// The program's version, "0.1.0".
[[nodiscard]] std::string version();
/// The commit that it was built from, 12 digits, with "-dirty" where files differed from it; empty:
/// not known.
[[nodiscard]] std::string commit();

/// Nanoseconds since 1970 in UTC as "2023-11-14T22:13:20.000190Z": ISO 8601 to the microsecond.
[[nodiscard]] std::string utc_text(std::int64_t time_ns);
/// The inverse; none for a text of another form.
[[nodiscard]] std::optional<std::int64_t> utc_ns(std::string_view text);

/// First and newest sample in UTC, ns since 1970. Absent: the record's own times have no epoch.
struct RecordedSpan {
  std::optional<std::int64_t> start_ns;
  std::optional<std::int64_t> end_ns;
};
/// Times before 1990 are counted from a start of their own.
[[nodiscard]] RecordedSpan recorded_span(std::int64_t first_ns, std::int64_t last_ns);
[[nodiscard]] RecordedSpan recorded_span_s(double first_s, double last_s);

/// Where a result comes from: the head of parameters.json. An empty text is null there.
struct Origin {
  std::string version;
  std::string commit;
  std::string source;  ///< as given
  std::string sha256;
  RecordedSpan recorded;
  std::string vehicle, truck, load, note;  ///< of [record]
  std::vector<InputFile> other_inputs;
  std::optional<std::int64_t> written_ns;  ///< of live.json alone: UTC, ns since 1970
};
/// The program, the words of [record], and what went in, the source first.
[[nodiscard]] Origin origin_of(const Config& config, const std::vector<InputFile>& inputs,
                               const RecordedSpan& recorded);

/// The complete configuration, and in the table [run] what went in. Loads back as a configuration.
[[nodiscard]] std::string write_run_toml(const Config& config,
                                         const std::vector<InputFile>& inputs);

/// What a run.toml says about the run itself.
struct Provenance {
  std::string version;
  std::vector<InputFile> inputs;
};

/// Throws RunError naming `origin` when [run] is missing or is not what write_run_toml() writes.
[[nodiscard]] Provenance read_provenance(std::string_view text, const std::string& origin);

}  // namespace dampline::app
