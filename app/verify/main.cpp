// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "app/error.hpp"
#include "app/program.hpp"
#include "app/verify/page.hpp"
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

int verify(const std::string& name, const VerifyOptions& options, const std::string& folder) {
  if (!folder.empty()) return write_page(name, options, folder);
  if (name.empty()) throw UsageError{"verify: found no SUBJECT, expected " + subject_help()};
  return subject_of(name).run(options);
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
  program.add_option("SUBJECT", subject, subject_help());
  std::string folder;
  program.add_option("--out", folder, "write one page with all tables; without SUBJECT: of all");
  program.add_option("--table", options.tables, "only this table of the publication (repeatable)")
      ->expected(1)
      ->take_all();
  auto* json = program.add_flag("--json", options.json, "print the figures as JSON");
  program.add_flag("--markdown", options.markdown, "print the figures as Markdown tables")
      ->excludes(json);
  program.add_flag("--quiet", options.quiet, "print nothing; the exit code tells");
  const auto action = [&] {
    std::signal(SIGPIPE, SIG_DFL);  // `verify ... | head` ends with its reader
    return verify(subject, options, folder);
  };
  return run(program, action, argc, argv);
}
