// SPDX-License-Identifier: MIT
// What a shell offers behind the Tab key, written from the command line as the program parses it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/verbs/verbs.hpp"

namespace dampline::app {
namespace {

/// One verb, or one verb of a verb ("config check").
struct Command {
  std::string words;
  std::string description;
  std::vector<const CLI::App*> verbs;
  std::vector<const CLI::Option*> options;
};

Command command_of(const CLI::App& app, std::string words) {
  const auto no_filter = std::function<bool(const CLI::App*)>{};
  std::vector<const CLI::Option*> options = app.get_options();
  std::erase_if(options, [](const CLI::Option* option) { return option->get_lnames().empty(); });
  return {std::move(words), app.get_description(), app.get_subcommands(no_filter),
          std::move(options)};
}

/// The program and all that is below it: two levels.
std::vector<Command> commands_of(const CLI::App& program) {
  std::vector<Command> out{command_of(program, "")};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::string before = out[i].words.empty() ? "" : out[i].words + " ";
    const auto verbs = out[i].verbs;
    for (const CLI::App* verb : verbs) out.push_back(command_of(*verb, before + verb->get_name()));
  }
  return out;
}

std::string names_of(const Command& command) {
  std::vector<std::string> names;
  for (const CLI::App* verb : command.verbs) names.push_back(verb->get_name());
  for (const CLI::Option* option : command.options)
    names.push_back("--" + option->get_lnames().front());
  return fmt::format("{}", fmt::join(names, " "));
}

std::string bash(const CLI::App& program) {
  std::string cases;
  std::string verbs;
  for (const Command& command : commands_of(program)) {
    cases += fmt::format("    '{}') words='{}' ;;\n", command.words, names_of(command));
    if (!command.words.empty()) verbs += fmt::format(" | '{}'", command.words);
  }
  return fmt::format(R"(# bash completion of dampline, written by `dampline completion bash`
_dampline() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command='' words='' word i
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${{COMP_WORDS[i]}}
    case "${{command:+$command }}$word" in
    {}) command+=${{command:+ }}$word ;;
    esac
  done
  case $command in
{}  esac
  if [[ $command == identify && $current != -* ]]; then # SOURCE may be a CAN interface
    for i in /sys/class/net/*; do
      [[ -r $i/type && $(<"$i/type") == 280 ]] && words+=" ${{i##*/}}"
    done
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o default -F _dampline dampline
)",
                     verbs.substr(verbs.find('\'')), cases);
}

/// Between brackets or behind a colon, in single quotes.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
    if (c == '\'') out += "\\''";
  }
  return out;
}

std::string zsh_option(const CLI::Option& option) {
  const bool is_flag = option.get_expected_max() == 0;
  return fmt::format("    '--{}[{}]{}'", option.get_lnames().front(),
                     zsh_text(option.get_description()), is_flag ? "" : ":value:_files");
}

std::string zsh_command(const Command& command) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : command.options) arguments.push_back(zsh_option(*option));
  if (command.verbs.empty()) arguments.emplace_back("    '*:file:_files'");
  std::string described;
  for (const CLI::App* verb : command.verbs)
    described += fmt::format(" '{}:{}'", verb->get_name(), zsh_text(verb->get_description()));
  const std::string verbs =
      described.empty()
          ? ""
          : fmt::format("    local -a verbs=({})\n    _describe verb verbs\n", described);
  return fmt::format("  '{}')\n{}    _arguments \\\n  {}\n    ;;\n", command.words, verbs,
                     fmt::join(arguments, " \\\n  "));
}

std::string zsh(const CLI::App& program) {
  std::string cases;
  std::string verbs;
  for (const Command& command : commands_of(program)) {
    cases += zsh_command(command);
    if (!command.words.empty())
      verbs += fmt::format("{}'{}'", verbs.empty() ? "" : " | ", command.words);
  }
  return fmt::format(R"(#compdef dampline
# zsh completion of dampline, written by `dampline completion zsh`
_dampline() {{
  local command='' word
  for word in ${{words[2,CURRENT-1]}}; do
    case "${{command:+$command }}$word" in
    {}) command+="${{command:+ }}$word" ;;
    esac
  done
  case $command in
{}  esac
}}
_dampline "$@"
)",
                     verbs, cases);
}

}  // namespace

void add_completion_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "completion", "Print what a shell needs to complete this program's command line");
  const auto shell = std::make_shared<std::string>();
  verb->add_option("SHELL", *shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  verb->callback([shell, &program, &action] {
    action = [shell, &program] {
      fmt::print("{}", *shell == "bash" ? bash(program) : zsh(program));
      return 0;
    };
  });
}

}  // namespace dampline::app
