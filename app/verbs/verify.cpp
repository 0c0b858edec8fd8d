// SPDX-License-Identifier: MIT
#include "app/verbs/verify.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "app/error.hpp"
#include "app/verify/fokker_planck.hpp"
#include "app/verify/phase.hpp"
#include "app/verify/subject.hpp"
#include "app/verify/wavelet.hpp"

namespace dampline::app {
namespace {

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

void add_verify_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "verify", "Recompute published cases and print them beside the published figures");
  const auto options = std::make_shared<VerifyOptions>();
  const auto subject = std::make_shared<std::string>();
  verb->add_option("SUBJECT", *subject, subject_help())->required();
  verb->add_option("--table", options->tables, "only this table of the publication (repeatable)")
      ->expected(1)
      ->take_all();
  auto* json = verb->add_flag("--json", options->json, "print the figures as JSON");
  verb->add_flag("--markdown", options->markdown, "print the figures as Markdown tables")
      ->excludes(json);
  verb->add_flag("--quiet", options->quiet, "print nothing; the exit code tells");
  verb->callback([options, subject, &action] {
    action = [options, subject] { return verify(*subject, *options); };
  });
}

}  // namespace dampline::app
