// SPDX-License-Identifier: MIT
#include "app/fleet/archive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/record/columns.hpp"
#include "app/record/rate.hpp"
#include "app/run/directory.hpp"
#include "app/run/disk.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::array<std::string_view, 4> kFolderWords{"vehicle", "truck", "load", ""};
constexpr const char* kMarker = "archive.toml";

/// As drivers/record/format.hpp knows them; before ".gz" and ".zst", too.
constexpr std::array<std::string_view, 11> kSuffixes{".log", ".txt", ".asc", ".blf", ".trc", ".mf4",
                                                     ".csv", ".npy", ".npz", ".mat", ".h5"};

bool is_record(fs::path file) {
  if (file.extension() == ".gz" || file.extension() == ".zst") file.replace_extension();
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return std::find(kSuffixes.begin(), kSuffixes.end(), suffix) != kSuffixes.end();
}

/// FNV-1a, 64 bits.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

Log log_of(const fs::path& file) {
  std::error_code error;
  const fs::path whole = fs::canonical(file, error);
  if (error) throw RunError{fmt::format("{}: {}", file.string(), error.message())};
  const std::uint64_t bytes = fs::file_size(whole, error);
  if (error) throw RunError{fmt::format("{}: {}", file.string(), error.message())};
  const auto changed = fs::last_write_time(whole, error).time_since_epoch().count();
  const std::string identity = fmt::format("{}\n{}\n{}", whole.string(), bytes, changed);
  return {whole, bytes,
          fmt::format("{}-{:016x}", file.stem().string().substr(0, 80), hash_of(identity))};
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string read_text(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_io(folder, "write into it", error.value());
}

/// Something that no worker puts there; several may begin at once.
bool holds_other(const fs::path& folder) {
  constexpr std::array<std::string_view, 5> kOurs{kMarker, "states", "set_aside", "slurm",
                                                  "merged"};
  std::error_code error;
  for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
       at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with('.') && std::find(kOurs.begin(), kOurs.end(), name) == kOurs.end())
      return true;
  }
  return false;
}

/// What the threads of one run share.
struct Work {
  const std::vector<const Log*>& logs;
  Tally tally;
  std::uint64_t all_bytes{0};
  std::atomic<std::size_t> next{0};
  std::mutex mutex;  ///< of the tally and the failure
  std::exception_ptr failure;
  Progress progress;
  Clock::time_point start{Clock::now()};
};

void show(Work& work) {
  if (!work.progress.due()) return;
  const Tally& t = work.tally;
  const double seconds = seconds_since(work.start);
  const double rate = static_cast<double>(t.bytes) / std::max(seconds, 1e-3);
  const double left_s = static_cast<double>(work.all_bytes - t.bytes) / std::max(rate, 1.0);
  work.progress.show(
      std::nullopt, 0.0,
      fmt::format("{} of {} logs, {} set aside, {:.0f} MB/s, {} left", t.made + t.set_aside,
                  work.logs.size(), t.set_aside, 1e-6 * rate, format_duration(left_s)));
}

}  // namespace

std::vector<Log> find_logs(const std::vector<std::string>& sources) {
  std::vector<Log> out;
  for (const std::string& source : sources) {
    std::error_code error;
    if (!fs::is_directory(source, error)) {
      out.push_back(log_of(source));
      continue;
    }
    for (const fs::path& file : files_below(source))
      if (is_record(file)) out.push_back(log_of(file));
  }
  std::sort(out.begin(), out.end(), [](const Log& a, const Log& b) {
    return std::tie(b.bytes, a.name) < std::tie(a.bytes, b.name);
  });
  out.erase(std::unique(out.begin(), out.end(),
                        [](const Log& a, const Log& b) { return a.name == b.name; }),
            out.end());
  if (out.empty())
    throw RunError{fmt::format("{}: holds no record; expected files whose names end in {}",
                               sources.front(), list_words(kSuffixes))};
  return out;
}

Archive::Archive(ArchiveOptions options) : options_{std::move(options)} {
  static_cast<void>(estimator_config(options_.config));
  const fs::path marker = options_.out / kMarker;
  const std::string shown = fmt::format("# --folders {}\n{}", fmt::join(options_.folders, "/"),
                                        show_config(options_.config));
  std::error_code error;
  if (fs::exists(marker, error)) {
    if (read_text(marker) != shown)
      throw UsageError{fmt::format(
          "{}: was made with another configuration than this one; expected the same, or another "
          "--out",
          marker.string())};
  } else if (holds_other(options_.out)) {
    throw UsageError{fmt::format("{}: holds something and is no archive (no {} in it)",
                                 options_.out.string(), kMarker)};
  }
  for (const char* name : {"states", "set_aside"}) {
    make_folder(options_.out / name);
    remove_stale(options_.out / name, std::string{kPartial});
  }
  if (!fs::exists(marker, error)) write_file(marker, shown);
}

bool Archive::is_done(const Log& log) const {
  std::error_code error;
  return fs::exists(states() / (log.name + ".dls"), error) ||
         fs::exists(options_.out / "set_aside" / (log.name + ".txt"), error);
}

Config Archive::config_of(const Log& log) const {
  Config config = options_.config;
  fs::path folder = log.file.parent_path();
  for (std::size_t i = options_.folders.size(); i-- > 0; folder = folder.parent_path()) {
    const std::string name = folder.filename().string();
    if (options_.folders[i] == "vehicle") config.record.vehicle = name;
    if (options_.folders[i] == "truck") config.record.truck = name;
    if (options_.folders[i] == "load") config.record.load = name;
  }
  return config;
}

bool Archive::make_state(const Log& log) const {
  std::string state;
  try {
    const SourceOptions source{log.file.string(), options_.skip_bad_lines};
    const RecognisedColumns seen = recognise_columns(config_of(log), source);
    const SourceKind kind = detect_source(seen.config, source);
    if (kind == SourceKind::kRigRows)
      throw RunError{fmt::format("{}: is a rig's record; states are of trucks", source.path)};
    const Config config = with_record_rate(seen.config, source, kind);
    Identified found = identify_source(config, source, kind, false);
    state = make_files(config, std::move(found.result), found.inputs, found.sums.get()).state;
  } catch (const RunError& error) {
    write_file(options_.out / "set_aside" / (log.name + ".txt"),
               fmt::format("{}\n{}\n", log.file.string(), error.what()));
    return false;
  }
  write_file(states() / (log.name + ".dls"), state);
  return true;
}

namespace {

template <class Make>
void work_off(Work& work, const Make& make) {
  for (std::size_t i = work.next++; i < work.logs.size(); i = work.next++) {
    const Log& log = *work.logs[i];
    try {
      const bool made = make(log);
      const std::lock_guard lock{work.mutex};
      ++(made ? work.tally.made : work.tally.set_aside);
      work.tally.bytes += log.bytes;
      show(work);
    } catch (...) {
      const std::lock_guard lock{work.mutex};
      work.failure = std::current_exception();
      work.next = work.logs.size();
    }
  }
}

}  // namespace

void Archive::try_again(const std::vector<Log>& logs) const {
  std::error_code error;
  for (const Log& log : logs) fs::remove(options_.out / "set_aside" / (log.name + ".txt"), error);
}

Tally Archive::run(const std::vector<Log>& logs, const Part& part) const {
  std::vector<const Log*> mine;
  Tally before;
  for (std::size_t i = part.part; i < logs.size(); i += part.of) {
    ++before.logs;
    if (is_done(logs[i]))
      ++before.before;
    else
      mine.push_back(&logs[i]);
  }
  Work work{mine, before, 0, {}, {}, {}, Progress{options_.progress}};
  for (const Log* log : mine) work.all_bytes += log->bytes;
  {
    std::vector<std::jthread> threads;
    const auto jobs = std::min(static_cast<std::size_t>(options_.jobs), mine.size());
    for (std::size_t t = 0; t < jobs; ++t)
      threads.emplace_back(
          [&] { work_off(work, [&](const Log& log) { return make_state(log); }); });
  }
  if (work.failure) std::rethrow_exception(work.failure);
  work.tally.seconds = seconds_since(work.start);
  return work.tally;
}

std::vector<Archive::SetAside> Archive::set_aside() const {
  std::vector<SetAside> out;
  for (const fs::directory_entry& entry : fs::directory_iterator{options_.out / "set_aside"}) {
    if (entry.path().extension() != ".txt") continue;
    const std::string text = read_text(entry.path());
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string reason = text.substr(std::min(end + 1, text.size()));
    while (!reason.empty() && reason.back() == '\n') reason.pop_back();
    out.push_back({text.substr(0, end), std::move(reason)});
  }
  std::sort(out.begin(), out.end(),
            [](const SetAside& a, const SetAside& b) { return a.log < b.log; });
  return out;
}

std::vector<std::string> parse_folders(const std::string& words) {
  std::vector<std::string> out;
  std::set<std::string> seen;
  for (std::size_t begin = 0; begin <= words.size() && !words.empty();) {
    const std::size_t end = std::min(words.find('/', begin), words.size());
    const std::string word = words.substr(begin, end - begin);
    const bool known =
        std::find(kFolderWords.begin(), kFolderWords.end(), word) != kFolderWords.end();
    if (!known || (!word.empty() && !seen.insert(word).second))
      throw UsageError{fmt::format(
          "--folders: found {}, expected names of a log's folders from the outermost on, "
          "\"vehicle\", \"truck\" and \"load\", with / between; nothing between two: any name",
          drivers::quote(words))};
    out.push_back(word);
    begin = end + 1;
  }
  return out;
}

}  // namespace dampline::app::fleet
