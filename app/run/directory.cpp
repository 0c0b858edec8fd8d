// SPDX-License-Identifier: MIT
#include "app/run/directory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/run/state.hpp"
#include "app/run/tables.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMarker = "run.toml";
/// What a run writes beside the black box.
constexpr std::array<std::string_view, 24> kRunFiles{
    kMarker,        "parameters.json", "curve.csv",        "densities.csv", "phase.json",
    "state.dls",    "report.html",     "convergence.csv",  "excluded.csv",  "motion.csv",
    "force.csv",    "windows.csv",     "cov.csv",          "term_sets.csv", "events.csv",
    "lateness.csv", "live.json",       "explanation.json", "residual.csv",  "loops.csv",
    "law.csv",      "law.json",        "prediction.csv",   "segments.csv"};

bool is_run_file(const std::string& name) {
  return std::find(kRunFiles.begin(), kRunFiles.end(), name) != kRunFiles.end() ||
         name.starts_with(kPartial);
}

std::vector<std::string> names_in(const fs::path& folder, std::error_code& error) {
  std::vector<std::string> names;
  for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
       at.increment(error))
    names.push_back(at->path().filename().string());
  return names;
}

/// Nothing but what an interrupted run left behind, which is no run and is continued.
bool only_remains(const fs::path& folder, std::error_code& error) {
  const std::vector<std::string> names = names_in(folder, error);
  return !error && std::all_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "blackbox" || (name != kMarker && is_run_file(name));
  });
}

/// A name that can be exchanged: no link, no ".".
fs::path plain(const fs::path& target) {
  std::error_code error;
  fs::path whole = fs::weakly_canonical(fs::absolute(target), error);
  if (error) fail_io(target, "write", error.value());
  return whole.has_filename() ? whole : whole.parent_path();
}

void rename_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail_io(to, "write", error.value());
}

}  // namespace

RunDirectory::RunDirectory(fs::path target, bool replace)
    : shown_{std::move(target)}, target_{plain(shown_)} {
  check_target(replace);
  make_target();
  try {
    make_staging();
  } catch (const RunError&) {
    remove_made();
    throw;
  }
}

void RunDirectory::check_target(bool replace) {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status))
    throw UsageError{fmt::format("{}: is a file; --out names a directory", shown_.string())};
  const bool is_free = only_remains(target_, error);
  if (error) fail_io(shown_, "read", error.value());
  if (is_free) return;
  if (!replace)
    throw UsageError{fmt::format("{}: holds something already; --force replaces an earlier run",
                                 shown_.string())};
  if (!fs::exists(target_ / kMarker))
    throw UsageError{fmt::format("{}: is not a run directory (no {} in it) and is not replaced",
                                 shown_.string(), kMarker)};
  replaces_ = true;
}

void RunDirectory::make_target() {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path folder = target_; !folder.empty() && !fs::exists(folder, error);
       folder = folder.parent_path())
    missing.push_back(folder);
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& folder : missing) {
    if (!fs::create_directory(folder, error) && error) {
      remove_made();
      fail_io(folder == target_ ? shown_ : folder, "write into it", error.value());
    }
    made_.insert(made_.begin(), folder);
  }
}

/// Beside the target, for one exchange of names; inside it where no name leads from there to it.
/// What a killed run left goes, an earlier one's of a series too: its name does not come again.
void RunDirectory::make_staging() {
  const fs::path parent = target_.parent_path();
  const fs::path name = target_.filename();
  const std::string number = name.extension();  // of a series
  const bool one_of_many = number.find_first_not_of("0123456789", 1) == std::string::npos;
  const std::string stem = fmt::format(".{}{}", name.string(), kPartial);
  remove_stale(target_, std::string{kPartial});
  remove_stale(parent, "." + (one_of_many ? name.stem() : name).string());
  std::error_code error;
  beside_ = same_mount(parent, target_) && ::access(parent.c_str(), W_OK | X_OK) == 0 &&
            !fs::equivalent(target_, fs::current_path(error), error);
  if (replaces_ && !beside_)
    throw UsageError{fmt::format(
        "{}: cannot be replaced in one step: it is a mount point, the working directory, or in a "
        "directory that cannot be written; expected another --out, or the earlier run removed",
        shown_.string())};
  staging_ = beside_ ? make_partial(parent, stem, lock_)
                     : make_partial(target_, std::string{kPartial}, lock_);
  std::vector<fs::path> folders{staging_};
  folders.insert(folders.end(), made_.begin(), made_.end());
  swept_.emplace(folders);
}

void RunDirectory::remove_made() noexcept {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());
}

RunDirectory::~RunDirectory() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (!committed_) remove_made();
}

void RunDirectory::write(const std::string& name, std::string_view content) {
  swept_.reset();
  write_new(lock_.get(), name, content, shown_);
  names_.push_back(name);
}

void RunDirectory::commit() {
  if (beside_) {
    change_names();
  } else {
    move_files();
  }
  sync_directory(target_.parent_path());
  committed_ = true;
}

/// One exchange. What lies in the target and is no file of a run, the black box above all, is in
/// both directories before it; where a file system has no links, it follows after.
void RunDirectory::change_names() {
  std::error_code error;
  std::vector<std::string> kept = names_in(target_, error);
  if (error) fail_io(shown_, "read", error.value());
  std::erase_if(kept, is_run_file);
  std::error_code ignored;
  for (const std::string& name : kept)
    static_cast<void>(link_tree(target_ / name, staging_ / name));
  fs::permissions(staging_, fs::status(target_, ignored).permissions(), ignored);
  sync_directory(staging_);
  exchange(target_.parent_path(), target_.filename().string(), staging_.filename().string());
  for (const std::string& name : kept)
    if (!fs::exists(fs::symlink_status(target_ / name, ignored)))
      rename_file(staging_ / name, target_ / name);
}

void RunDirectory::move_files() {
  std::error_code ignored;
  for (const std::string_view name : kRunFiles) fs::remove(target_ / name, ignored);
  std::stable_partition(names_.begin(), names_.end(),
                        [](const std::string& name) { return name != kMarker; });
  for (const std::string& name : names_) rename_file(staging_ / name, target_ / name);
  sync_directory(target_);
}

namespace {

/// N of STEM.run.N, 1 of STEM.run, else 0.
std::uint64_t run_number(const std::string& name, const std::string& stem) {
  if (!name.starts_with(stem)) return 0;
  if (name.size() == stem.size()) return 1;
  std::uint64_t number = 0;
  const char* const end = name.data() + name.size();
  const auto [at, error] = std::from_chars(name.data() + stem.size() + 1, end, number);
  return name[stem.size()] == '.' && error == std::errc{} && at == end ? number : 0;
}

/// By their numbers.
std::map<std::uint64_t, fs::path> runs_named(const fs::path& folder, const std::string& stem) {
  std::map<std::uint64_t, fs::path> found;
  std::error_code error;
  for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
       at.increment(error))
    if (const auto number = run_number(at->path().filename().string(), stem); number > 0)
      found.emplace(number, at->path());
  return found;
}

}  // namespace

fs::path free_run_name(const fs::path& folder, const std::string& stem) {
  const auto runs = runs_named(folder, stem + ".run");
  if (runs.empty()) return folder / (stem + ".run");
  return folder / fmt::format("{}.run.{}", stem, runs.rbegin()->first + 1);
}

std::vector<fs::path> remove_old_runs(const fs::path& folder, const std::string& stem,
                                      std::size_t keep) {
  auto runs = runs_named(folder, stem + ".run");
  std::vector<fs::path> removed;
  for (auto run = runs.begin(); runs.size() > keep && run != runs.end(); run = runs.erase(run)) {
    std::error_code error;
    const bool ours =
        fs::is_directory(fs::symlink_status(run->second, error)) &&
        (fs::exists(run->second / kMarker, error) || only_remains(run->second, error));
    if (ours && fs::remove_all(run->second, error) > 0 && !error) removed.push_back(run->second);
  }
  return removed;
}

namespace {

std::string read_text(const std::filesystem::path& file) {
  auto text = drivers::read_whole(file.string());
  if (!text) throw RunError{text.error_text()};
  return std::move(text.value());
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
  if (!files.segments.empty()) directory.write("segments.csv", files.segments);
  if (!result.convergence.rows.empty())
    directory.write("convergence.csv", to_csv(result.convergence));
  if (!result.motion.empty()) directory.write("motion.csv", to_csv(result.motion));
  if (!result.force.empty()) directory.write("force.csv", to_csv(result.force));
  directory.write("excluded.csv", to_csv(result.excluded));
  if (!result.events.empty()) directory.write("events.csv", to_csv(result.events));
  if (!result.lateness.empty()) directory.write("lateness.csv", to_csv(result.lateness));
  if (!result.windows.rows.empty()) directory.write("windows.csv", to_csv(result.windows));
  if (!result.cov.empty()) directory.write("cov.csv", to_csv(result.cov, result.parameters));
  if (!result.term_sets.empty()) directory.write("term_sets.csv", to_csv(result.term_sets));
  if (!result.law.empty()) directory.write("law.json", result.law);
  stage_evidence(result.evidence, directory);
  directory.write("run.toml", files.run_toml);
}

namespace {

/// Of a record without a date: the beginning of its checksum.
std::uint64_t record_number(const std::string& sha256) {
  constexpr int kHexadecimal = 16;
  std::uint64_t number = 0;
  const std::string_view head = std::string_view{sha256}.substr(0, 2 * sizeof(number));
  std::from_chars(head.data(), head.data() + head.size(), number, kHexadecimal);
  return number;
}

}  // namespace

StateAbout state_about(const Config& config, const RunResult& result, const Statistics& sums) {
  const Origin& origin = result.origin;
  StateAbout about;
  about.segment = {origin.vehicle, origin.truck, origin.recorded.start_ns.value_or(0), 0};
  if (!origin.recorded.start_ns) about.segment.record = record_number(origin.sha256);
  about.end_ns = origin.recorded.end_ns.value_or(0);
  about.sequence = sums.header.counts.samples;
  about.load = origin.load;
  about.moving_mass_kg = config.car.moving_mass_kg;
  about.rate_hz = result.sample_rate_hz.value_or(Estimate{});
  const auto& base = config.model.base;
  about.viscous = std::find(base.begin(), base.end(), "viscous") != base.end();
  about.trust = result.trust;
  about.coulomb_n = estimate_of(result.parameters, "coulomb");
  about.stiffness_npm = estimate_of(result.parameters, "stiffness");
  return about;
}

RunFiles make_files(const Config& config, RunResult result, const std::vector<InputFile>& inputs,
                    const Statistics* sums) {
  result.origin = origin_of(config, inputs, result.origin.recorded);
  std::string state =
      sums == nullptr ? "" : encode_state(*sums, state_about(config, result, *sums));
  return {std::move(result), write_run_toml(config, inputs), std::move(state), ""};
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
  files.result.windows = read_extra(run / "windows.csv", read_convergence);
  files.result.cov = read_extra(run / "cov.csv", read_cov);
  files.result.term_sets = read_extra(run / "term_sets.csv", read_table<TermSet>);
  files.result.evidence = read_evidence(run);
  if (std::filesystem::exists(run / "law.json")) files.result.law = read_text(run / "law.json");
  return files;
}

}  // namespace dampline::app
