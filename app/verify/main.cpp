// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/series.hpp"
#include "app/error.hpp"
#include "app/program.hpp"
#include "app/record/columns.hpp"
#include "app/verify/page.hpp"
#include "app/verify/subjects.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::app {
namespace {

struct VerifySubject {
  const char* name;
  const char* meaning;  ///< for --help
  int (*run)(const VerifyOptions&);
};

/// Every subject has one line here.
const std::vector<VerifySubject>& subjects() {
  static const std::vector<VerifySubject> all{
      {"fokker-planck", "damping from stationary densities (Kisilowski and Urbanski 1987)",
       &verify_fokker_planck},
      {"phase", "resonances, sections and friction of the phase mappings", &verify_phase},
      {"wavelet", "wavelet-Galerkin identification (Ghanem and Romeo 2001)", &verify_wavelet},
  };
  return all;
}

std::string subject_help() {
  std::string text = "one of";
  for (const VerifySubject& subject : subjects())
    text += fmt::format("{} {}: {}", &subject == subjects().data() ? "" : ";", subject.name,
                        subject.meaning);
  return text;
}

const VerifySubject& subject_of(const std::string& name) {
  std::string known;
  for (const VerifySubject& subject : subjects()) {
    if (name == subject.name) return subject;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", subject.name);
  }
  throw UsageError{fmt::format("verify: found '{}', expected one of: {}", name, known)};
}

/// One page of the subject, or of all of them, in the folder.
int write_page(const std::string& name, VerifyOptions options,
               const std::filesystem::path& folder) {
  std::string body;
  int code = 0;
  options.markdown = true;
  for (const VerifySubject& subject : subjects()) {
    if (!name.empty() && &subject_of(name) != &subject) continue;
    std::string markdown;
    options.page = &markdown;
    code = std::max(code, subject.run(options));
    body += fmt::format("<h2>{}: {}</h2>\n", subject.name, subject.meaning);
    body += html_of_markdown(markdown);
  }
  std::filesystem::create_directories(folder);
  const std::filesystem::path path = folder / "verify.html";
  std::ofstream out{path};
  out << whole_page("Published cases, recomputed", body);
  out.close();
  if (!out) throw RunError{fmt::format("verify --out: {} cannot be written", path.string())};
  if (!options.quiet) fmt::print("{}\n", path.string());
  return code;
}

/// Measured records to look at, beside the published cases.
struct Measured {
  std::vector<std::string> files;
  std::string config;   ///< of their columns; empty: by their headers
  double mass_kg{0.0};  ///< that moves with the deflection; its inertia is no force of the element
};

/// m y'' with sixth-order differences of the velocity; at the ends, where these do not reach, NaN.
std::vector<double> inertia_n(const rig::Series& series, double mass_kg) {
  const auto window = rig::core::DerivativeWindow::sharp(series.interval_s);
  const Eigen::Index reach = window.half_width();
  std::vector<double> out(static_cast<std::size_t>(series.size()), std::nan(""));
  for (Eigen::Index i = reach; i + reach < series.size(); ++i) {
    double accel_mps2 = 0.0;
    for (int j = 1; j <= window.half_width(); ++j)
      accel_mps2 += window.weight(j) * (series.velocity_mps[i + j] - series.velocity_mps[i - j]);
    out[static_cast<std::size_t>(i)] = mass_kg * accel_mps2;
  }
  return out;
}

/// A rig's record as `identify` reads it.
MeasuredRecord read_record(const std::string& path, const Measured& measured) {
  const Config config = measured.config.empty() ? Config{} : load_config(measured.config);
  const rig::Series series =
      rig::read_series(path, recognise_columns(config, {.path = path}).config, false, "");
  const auto values = [](const Eigen::VectorXd& of) {
    return std::vector<double>(of.begin(), of.end());
  };
  MeasuredRecord out{std::filesystem::path{path}.stem().string(), series.interval_s,
                     values(series.deflection_m), values(series.velocity_mps),
                     values(series.force_n)};
  if (measured.mass_kg == 0.0) return out;
  const std::vector<double> inertia = inertia_n(series, measured.mass_kg);
  std::transform(out.force_n.begin(), out.force_n.end(), inertia.begin(), out.force_n.begin(),
                 std::minus{});
  return out;
}

int verify(const std::string& name, VerifyOptions options, const Measured& measured,
           const std::string& folder) {
  if (!measured.files.empty() && name != "phase")
    throw UsageError{fmt::format("verify --record: found SUBJECT '{}', expected phase", name)};
  for (const std::string& file : measured.files)
    options.records.push_back(read_record(file, measured));
  if (!folder.empty()) return write_page(name, options, folder);
  if (name.empty()) throw UsageError{"verify: found no SUBJECT, expected " + subject_help()};
  return subject_of(name).run(options);
}

}  // namespace
}  // namespace dampline::app

/// `dampline verify` becomes this program; see app/verbs/programs.hpp.
int main(int argc, char** argv) {
  using namespace dampline::app;
  CLI::App program{"Recompute published cases and print them beside the published figures"};
  program.name("dampline verify");
  VerifyOptions options;
  std::string subject;
  program.add_option("SUBJECT", subject, subject_help());
  std::string folder;
  program.add_option("--out", folder, "write one page with all tables; without SUBJECT: of all");
  program.add_option("--table", options.tables, "only this table of the publication (repeatable)")
      ->expected(1)
      ->take_all();
  auto* json = program.add_flag("--json", options.json, "print the figures as JSON");
  program.add_flag("--markdown", options.markdown, "print the figures as Markdown tables")
      ->excludes(json);
  Measured measured;
  auto* record =
      program
          .add_option(
              "--record", measured.files,
              "phase: a rig's record in CSV (repeatable); both evidences of linearity on it")
          ->expected(1)
          ->take_all();
  program.add_option("--config", measured.config, "columns of the records (TOML, [input])")
      ->needs(record);
  program.add_option("--mass", measured.mass_kg, "kg that move with the deflection of the records")
      ->check(CLI::NonNegativeNumber)
      ->needs(record);
  program.add_flag("--quiet", options.quiet, "print nothing; the exit code tells");
  const auto action = [&] {
    std::signal(SIGPIPE, SIG_DFL);  // `verify ... | head` ends with its reader
    return verify(subject, options, measured, folder);
  };
  return run(program, action, argc, argv);
}
