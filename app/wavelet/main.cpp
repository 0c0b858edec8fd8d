// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/program.hpp"
#include "app/report/page.hpp"
#include "app/run/directory.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/wavelet/identify.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app::wavelet {
namespace {

struct Flags {
  Settings settings;
  std::string method;
  std::string config;
  std::string out;
  int level{-1};
  bool no_gate{false};
  bool recursive{false};
  bool json{false};
  bool quiet{false};
  bool force{false};
  bool no_report{false};
  bool strict{false};
};

int act(const Flags& flags) {
  Settings settings = flags.settings;
  settings.gated = !flags.no_gate;
  if (flags.level >= 0) settings.level = flags.level;
  const std::string& source = settings.record.source.path;
  const std::filesystem::path place =
      flags.out.empty() ? free_run_name(std::filesystem::current_path(),
                                        std::filesystem::path{source}.stem().string())
                        : std::filesystem::path{flags.out};
  const Config config = flags.config.empty() ? Config{} : load_config(flags.config);
  RunDirectory directory{place, flags.force};
  const RunFiles files = make_files(config, identify(config, settings), {describe_record(source)});
  stage_files(files, directory);
  if (!flags.no_report) stage_report(files, directory);
  directory.commit();
  const RunResult& result = files.result;
  if (flags.json) fmt::print("{}", to_json(result));
  if (!flags.json && !flags.quiet)
    fmt::print("{}  {:<28} {}\n", drivers::printable(table_of(result), true),
               flags.no_report ? "results" : "report",
               drivers::printable((flags.no_report ? place : place / "report.html").string()));
  if (result.trust == Trust::kTrusted) return 0;
  if (flags.json || flags.quiet || flags.strict)
    warn(fmt::format("{}: {}", dampline::app::name_of(result.trust),
                     fmt::join(result.trust_reasons, " ")));
  constexpr int kNotTrusted = 3;
  return flags.strict ? kNotTrusted : 0;
}

void add_record_options(CLI::App& program, Flags& flags) {
  MeasuredOptions& record = flags.settings.record;
  program
      .add_option("SOURCE", record.source.path,
                  "FILE.csv: deflection and force, or accelerations of base and response")
      ->required();
  program.add_option("--method", flags.method, "wavelet: this method")
      ->required()
      ->check(CLI::IsMember({"wavelet"}));
  program.add_option("--masses", record.masses, "1, or 2 in a chain: deflection1_m, force1_n, ...")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  program
      .add_option("--mass", flags.settings.mass_kg,
                  "kg, of each mass that the force drives; without it and without the term a, "
                  "the force is the element's own")
      ->delimiter(',')
      ->check(CLI::Range(1e-9, 1e12));
  program
      .add_option("--block", record.block_s,
                  "s, of accelerations: blocks that are integrated; twelve periods of the motion")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  program.add_option("--config", flags.config,
                     "configuration (TOML): [input.columns], [input.scale]");
  program.add_flag("--skip-bad-lines", record.source.skip_bad_lines,
                   "count malformed lines instead of stopping at the first");
}

void add_method_options(CLI::App& program, Flags& flags) {
  Settings& s = flags.settings;
  program
      .add_option("--terms", s.terms,
                  "terms with commas between, as \"v, x, x^3, sign(v)\"; of two masses once for "
                  "both elements or once for each, the one to the ground first. Terms:\n" +
                      vocabulary_text())
      ->expected(1)
      ->take_all()
      ->required();
  const std::map<std::string, Wavelet> wavelets{
      {"D6", Wavelet::kD6}, {"D8", Wavelet::kD8}, {"D12", Wavelet::kD12}, {"D16", Wavelet::kD16}};
  program.add_option("--wavelet", s.wavelet, "D6, D8 (the default), D12 or D16")
      ->transform(CLI::CheckedTransformer(wavelets, CLI::ignore_case));
  program
      .add_option(
          "--level", flags.level,
          "octaves below the record's rate, 0 to 8; default: where noise and step harm least")
      ->check(CLI::Range(0, kDeepestLevel));
  auto* windows = program.add_option("--windows", s.window_rows,
                                     "fit windows of so many rows, and state mean and scatter; 32 "
                                     "in the publication");
  windows->check(CLI::Range(2, 1000000000));
  program.add_flag("--recursive", flags.recursive, "least squares over all rows: the default")
      ->excludes(windows);
  program.add_flag("--no-gate", flags.no_gate,
                   "keep rows that reach across a kink of a term, as the publication does");
  program.add_flag("--choose-terms", s.compares,
                   "compare term sets: each term left out, each of the vocabulary added");
}

void add_output_options(CLI::App& program, Flags& flags) {
  program.add_option("--out", flags.out,
                     "run directory; default: a new one named after the source");
  program.add_flag("--force", flags.force, "replace an earlier run in --out");
  program.add_flag("--json", flags.json, "print parameters.json instead of a table");
  program.add_flag("--quiet", flags.quiet, "print nothing but errors and warnings");
  program.add_flag("--no-report", flags.no_report, "do not draw report.html");
  program.add_flag("--strict", flags.strict, "end with 3 where the result is not to be trusted");
}

}  // namespace
}  // namespace dampline::app::wavelet

/// `dampline identify SOURCE --method wavelet` becomes this program; see app/verbs/programs.hpp.
int main(int argc, char** argv) {
  namespace wavelet = dampline::app::wavelet;
  CLI::App program{
      "Fit terms of your choice to measured motion and force by wavelet-Galerkin rows (Ghanem and "
      "Romeo 2001)"};
  program.name("dampline identify");
  wavelet::Flags flags;
  wavelet::add_record_options(program, flags);
  wavelet::add_method_options(program, flags);
  wavelet::add_output_options(program, flags);
  return dampline::app::run(
      program, [&] { return wavelet::act(flags); }, argc, argv);
}
