// SPDX-License-Identifier: MIT
#include "app/run/directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/run/tables.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMarker = "run.toml";
/// What an earlier run may have left and this one may not write.
constexpr std::array<std::string_view, 18> kRunFiles{
    "parameters.json", "curve.csv",       "densities.csv", "phase.json",       "state.dls",
    "report.html",     "convergence.csv", "excluded.csv",  "motion.csv",       "force.csv",
    "events.csv",      "lateness.csv",    "live.json",     "explanation.json", "residual.csv",
    "loops.csv",       "law.csv",         "prediction.csv"};
/// What a live run writes before its end: an interrupted one is continued beside it.
constexpr std::array<std::string_view, 2> kLiveFiles{"blackbox", "live.json"};

/// Nothing but what an interrupted live run left behind.
bool only_live_files(const fs::path& folder) {
  return std::all_of(fs::directory_iterator{folder}, fs::directory_iterator{},
                     [](const fs::directory_entry& entry) {
                       const std::string name = entry.path().filename().string();
                       return name.starts_with(".partial-") ||
                              std::find(kLiveFiles.begin(), kLiveFiles.end(), name) !=
                                  kLiveFiles.end();
                     });
}

[[noreturn]] void fail(const fs::path& path, std::string_view action, int error) {
  throw RunError{fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(error))};
}

void write_all(int descriptor, std::string_view content, const fs::path& file) {
  while (!content.empty()) {
    const ssize_t count = ::write(descriptor, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(file, "write", errno);
    content.remove_prefix(static_cast<std::size_t>(count));
  }
}

/// Closes on every way out; close() itself may report that the disk is full.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_{number} {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int get() const { return number_; }
  [[nodiscard]] int close() {
    const int result = ::close(number_);
    number_ = -1;
    return result;
  }

 private:
  int number_;
};

void write_new(const fs::path& file, std::string_view content) {
  Descriptor out{::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
  if (out.get() < 0) fail(file, "create", errno);
  write_all(out.get(), content, file);
  if (::fsync(out.get()) != 0) fail(file, "write", errno);
  if (out.close() != 0) fail(file, "write", errno);
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, "write", error.value());
}

void sync_directory(const fs::path& folder) {
  const Descriptor handle{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (handle.get() >= 0) ::fsync(handle.get());
}

}  // namespace

void write_file(const fs::path& file, std::string_view content) {
  fs::path staged = file;
  staged += fmt::format(".partial-{}", ::getpid());
  try {
    write_new(staged, content);
    move_file(staged, file);
  } catch (const RunError&) {
    std::error_code ignored;
    fs::remove(staged, ignored);
    throw;
  }
}

RunDirectory::RunDirectory(fs::path target, bool replace) : target_{std::move(target)} {
  check_target(replace);
  staging_ = target_ / fmt::format(".partial-{}", ::getpid());
  make_target();
}

void RunDirectory::check_target(bool replace) const {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status))
    throw UsageError{fmt::format("{}: is a file; --out names a directory", target_.string())};
  const bool empty = fs::is_empty(target_, error);
  if (error) fail(target_, "read", error.value());
  if (empty || only_live_files(target_)) return;
  if (!replace)
    throw UsageError{fmt::format("{}: holds something already; --force replaces an earlier run",
                                 target_.string())};
  if (!fs::exists(target_ / kMarker))
    throw UsageError{fmt::format("{}: is not a run directory (no {} in it) and is not replaced",
                                 target_.string(), kMarker)};
}

void RunDirectory::make_target() {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path folder = staging_; !folder.empty() && !fs::exists(folder, error);
       folder = folder.parent_path())
    missing.push_back(folder);
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& folder : missing) {
    if (!fs::create_directory(folder, error) && error) {
      remove_made();
      fail(folder.filename() == staging_.filename() ? target_ : folder, "write into it",
           error.value());
    }
    made_.insert(made_.begin(), folder);
  }
}

void RunDirectory::remove_made() noexcept {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());
}

RunDirectory::~RunDirectory() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (committed_) return;
  remove_made();
}

void RunDirectory::write(const std::string& name, std::string_view content) {
  write_new(staging_ / name, content);
  names_.push_back(name);
}

void RunDirectory::commit() {
  std::error_code error;
  fs::remove(target_ / kMarker, error);
  if (error) fail(target_ / kMarker, "replace", error.value());
  for (const std::string_view stale : kRunFiles) fs::remove(target_ / stale, error);
  std::stable_partition(names_.begin(), names_.end(),
                        [](const std::string& name) { return name != kMarker; });
  for (const std::string& name : names_) move_file(staging_ / name, target_ / name);
  sync_directory(target_);
  committed_ = true;
}

fs::path free_run_name(const fs::path& folder, const std::string& stem) {
  fs::path name = folder / (stem + ".run");
  for (int number = 2; fs::exists(name); ++number)
    name = folder / fmt::format("{}.run.{}", stem, number);
  return name;
}

namespace {

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  std::string text{std::istreambuf_iterator<char>{stream}, {}};
  if (!stream.is_open() || stream.bad())
    throw RunError{fmt::format("{}: cannot be read", file.string())};
  return text;
}

/// An extra table, which a run need not have.
template <class Read>
auto read_extra(const std::filesystem::path& file, Read read) {
  using Table = decltype(read(std::string_view{}, std::string{}));
  return std::filesystem::exists(file) ? read(read_text(file), file.string()) : Table{};
}

void stage_evidence(const Evidence& evidence, RunDirectory& directory) {
  if (evidence.explanation.empty()) return;
  directory.write("explanation.json", evidence.explanation);
  if (!evidence.residual.empty()) directory.write("residual.csv", to_csv(evidence.residual));
  if (!evidence.loops.empty()) directory.write("loops.csv", to_csv(evidence.loops));
  if (!evidence.law.empty()) directory.write("law.csv", to_csv(evidence.law));
  if (!evidence.prediction.empty()) directory.write("prediction.csv", to_csv(evidence.prediction));
}

Evidence read_evidence(const std::filesystem::path& run) {
  Evidence out;
  if (!std::filesystem::exists(run / "explanation.json")) return out;
  out.explanation = read_text(run / "explanation.json");
  out.residual = read_extra(run / "residual.csv", read_table<ResidualRow>);
  out.loops = read_extra(run / "loops.csv", read_table<LoopRow>);
  out.law = read_extra(run / "law.csv", read_table<LawRow>);
  out.prediction = read_extra(run / "prediction.csv", read_prediction);
  return out;
}

}  // namespace

void stage_files(const RunFiles& files, RunDirectory& directory) {
  const RunResult& result = files.result;
  directory.write("parameters.json", to_json(result));
  directory.write("curve.csv", to_csv(result.curve, result.methods));
  if (!result.densities.empty()) directory.write("densities.csv", to_csv(result.densities));
  if (result.phase) directory.write("phase.json", to_json(*result.phase));
  if (!files.state.empty()) directory.write("state.dls", files.state);
  if (!result.convergence.rows.empty())
    directory.write("convergence.csv", to_csv(result.convergence));
  if (!result.motion.empty()) directory.write("motion.csv", to_csv(result.motion));
  if (!result.force.empty()) directory.write("force.csv", to_csv(result.force));
  directory.write("excluded.csv", to_csv(result.excluded));
  if (!result.events.empty()) directory.write("events.csv", to_csv(result.events));
  if (!result.lateness.empty()) directory.write("lateness.csv", to_csv(result.lateness));
  stage_evidence(result.evidence, directory);
  directory.write("run.toml", files.run_toml);
}

RunFiles read_files(const std::filesystem::path& run) {
  if (!std::filesystem::is_directory(run))
    throw RunError{fmt::format("{}: is no directory", run.string())};
  const std::filesystem::path marker = run / "run.toml";
  if (!std::filesystem::exists(marker))
    throw RunError{fmt::format("{}: is not a run directory: it holds no run.toml", run.string())};
  RunFiles files;
  files.run_toml = read_text(marker);
  const auto parameters = run / "parameters.json";
  files.result = from_json(read_text(parameters), parameters.string());
  const auto curve = run / "curve.csv";
  read_curve(read_text(curve), curve.string(), files.result);
  files.result.densities = read_extra(run / "densities.csv", read_densities);
  files.result.phase = read_extra(run / "phase.json", read_phase);
  files.result.convergence = read_extra(run / "convergence.csv", read_convergence);
  files.result.motion = read_extra(run / "motion.csv", read_table<MotionRow>);
  files.result.force = read_extra(run / "force.csv", read_table<ForceRow>);
  files.result.excluded = read_extra(run / "excluded.csv", read_table<Excluded>);
  files.result.events = read_extra(run / "events.csv", read_table<RunEvent>);
  files.result.lateness = read_extra(run / "lateness.csv", read_table<LatenessRow>);
  files.result.evidence = read_evidence(run);
  return files;
}

}  // namespace dampline::app
