// SPDX-License-Identifier: MIT
#include "app/run/files.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "app/error.hpp"
#include "app/run/evidence_tables.hpp"
#include "app/run/parameters_json.hpp"
#include "app/run/phase_json.hpp"
#include "app/run/tables.hpp"

namespace dampline::app {
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
  out.residual = read_extra(run / "residual.csv", read_residual);
  out.loops = read_extra(run / "loops.csv", read_loops);
  out.law = read_extra(run / "law.csv", read_law);
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
  files.result.motion = read_extra(run / "motion.csv", read_motion);
  files.result.force = read_extra(run / "force.csv", read_force);
  files.result.excluded = read_extra(run / "excluded.csv", read_excluded);
  files.result.events = read_extra(run / "events.csv", read_events);
  files.result.lateness = read_extra(run / "lateness.csv", read_lateness);
  files.result.evidence = read_evidence(run);
  return files;
}

}  // namespace dampline::app
