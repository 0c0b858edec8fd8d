// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "app/program.hpp"
#include "app/verify/subjects.hpp"

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

int verify(const std::string& name, const VerifyOptions& options) {
  std::string known;
  for (const VerifySubject& subject : subjects()) {
    if (name == subject.name) return subject.run(options);
    known += fmt::format("{}{}", known.empty() ? "" : ", ", subject.name);
  }
  throw UsageError{fmt::format("verify: found '{}', expected one of: {}", name, known)};
}

}  // namespace
}  // namespace dampline::app

/// `dampline verify` becomes this program; see app/verbs/verify.hpp.
int main(int argc, char** argv) {
  using namespace dampline::app;
  CLI::App program{"Recompute published cases and print them beside the published figures"};
  program.name("dampline verify");
  VerifyOptions options;
  std::string subject;
  program.add_option("SUBJECT", subject, subject_help())->required();
  program.add_option("--table", options.tables, "only this table of the publication (repeatable)")
      ->expected(1)
      ->take_all();
  auto* json = program.add_flag("--json", options.json, "print the figures as JSON");
  program.add_flag("--markdown", options.markdown, "print the figures as Markdown tables")
      ->excludes(json);
  program.add_flag("--quiet", options.quiet, "print nothing; the exit code tells");
  return run(
      program, [&] { return verify(subject, options); }, argc, argv);
}
