// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/predict/rig.hpp"
#include "app/predict/truck.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

struct PredictFlags {
  std::string run;
  PredictOptions options;
  std::string config;
  std::string out{"-"};
  bool free_run{false};
  bool force{false};
  bool json{false};
  bool quiet{false};
};

/// Of a run directory, or the file itself.
law::Document load_law(const std::filesystem::path& run) {
  const bool is_run = std::filesystem::is_directory(run);
  const std::filesystem::path file = is_run ? run / "law.json" : run;
  if (is_run && !std::filesystem::exists(file))
    throw RunError{fmt::format(
        "{}: holds no law.json; `dampline explain RECORD --out RUN` writes one", run.string())};
  constexpr std::uintmax_t kMost = std::uintmax_t{16} << 20U;
  std::error_code error;
  if (std::filesystem::file_size(file, error) > kMost || error)
    throw RunError{fmt::format("{}: cannot be read as a law", file.string())};
  const auto text = drivers::read_whole(file.string());
  if (!text) throw RunError{text.error_text()};
  return law::read_document(text.value(), file.string());
}

Prediction predict(const PredictFlags& flags) {
  const law::Document document = load_law(flags.run);
  const Config config = flags.config.empty() ? Config{} : load_config(flags.config);
  if (document.subject == law::Subject::kTruck)
    return predict_frame(document, config, {flags.options.input, flags.options.skip_bad_lines});
  return flags.free_run ? predict_motion(document, config, flags.options)
                        : predict_force(document, config, flags.options);
}

int run_predict(const PredictFlags& flags) {
  if (flags.json && flags.out == "-")
    throw UsageError{"--json: prints on the standard output, expected a file in --out"};
  const Prediction prediction = predict(flags);
  write_prediction(prediction, flags.out, flags.force);
  if (flags.json) fmt::print("{}", prediction_json(prediction));
  if (!flags.json && !flags.quiet)
    fmt::print(flags.out == "-" ? stderr : stdout, "{}-> {}\n",
               drivers::printable(prediction_text(prediction), true),
               flags.out == "-" ? "standard output" : drivers::printable(flags.out));
  return 0;
}

}  // namespace

void add_predict_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "predict", "What an explained law does under another input, with its band");
  const auto flags = std::make_shared<PredictFlags>();
  verb->add_option("RUN", flags->run, "run directory of explain, or its law.json")->required();
  verb->add_option("--input", flags->options.input,
                   "a rig's record: its motion, from which the force is predicted; with --free-run "
                   "its force, which moves the mass; or a truck's, whose wheelsets move the frame")
      ->required();
  verb->add_flag("--free-run", flags->free_run, "a driven mass: predict its motion by its force");
  verb->add_option("--out", flags->out,
                   "table (CSV) of the prediction, its deviation and what was measured")
      ->capture_default_str();
  verb->add_option("--config", flags->config, "configuration (TOML) of the input: [input]");
  verb->add_flag("--force", flags->force, "replace a file that exists");
  verb->add_flag("--json", flags->json, "print the errors as JSON");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", flags->options.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->callback([flags, &action] { action = [flags] { return run_predict(*flags); }; });
}

}  // namespace dampline::app
