// SPDX-License-Identifier: MIT
// What the shells get, asked of the shells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "tests/service/shell.hpp"

namespace dampline::service {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kProgram = "'" DAMPLINE_BINARY_DIR "/dampline' ";

/// What bash offers behind `line`, a word a line; the last word is the one that is completed.
std::string offered(const std::string& line) {
  const Folder folder;
  const std::filesystem::path script = folder.path() / "ask.sh";
  std::ofstream{script} << "source <(" << kProgram << "completion bash)\n"
                        << "COMP_WORDS=(" << line << ")\n"
                        << "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_dampline\n"
                        << "printf '%s\\n' \"${COMPREPLY[@]}\"\n";
  const Ended ended = shell("bash " + quoted(script));
  EXPECT_EQ(ended.status, 0) << ended.output;
  return ended.output;
}

TEST(Completion, OffersTheVerbsThatTheHelpLists) {
  const std::string words = offered("dampline ''");
  const std::string help = shell(kProgram + "--help").output;
  const std::regex verb{"\n  ([a-z]+) "};
  int verbs = 0;
  for (std::sregex_iterator it{help.begin() + static_cast<long>(help.find("Subcommands:")),
                               help.end(), verb};
       it != std::sregex_iterator{}; ++it, ++verbs)
    EXPECT_THAT(words, HasSubstr((*it)[1].str() + "\n"));
  EXPECT_GT(verbs, 5);
}

TEST(Completion, OffersTheFlagsOfTheVerbAtHand) {
  EXPECT_EQ(offered("dampline identify --for"), "--force\n");
  EXPECT_EQ(offered("dampline simulate --load empty --see"), "--seed\n");
  EXPECT_THAT(offered("dampline config ''"), HasSubstr("check\n"));
  EXPECT_EQ(offered("dampline config c"), "check\n");
  // A file that is called like a verb changes nothing.
  EXPECT_EQ(offered("dampline identify report --dur"), "--duration\n");
}

TEST(Completion, LeavesFilesToTheShell) {
  EXPECT_EQ(offered("dampline explain record"), "\n");
  EXPECT_THAT(shell(kProgram + "completion bash").output,
              HasSubstr("complete -o default -F _dampline dampline"));
}

TEST(Completion, IsUnderstoodByZsh) {
  const std::string text = shell(kProgram + "completion zsh").output;
  EXPECT_TRUE(text.starts_with("#compdef dampline\n"));
  EXPECT_THAT(text, HasSubstr("'--force[replace an earlier run in --out]'"));
  EXPECT_THAT(text, HasSubstr("'--config["));
  if (!has_program("zsh")) GTEST_SKIP() << "zsh is not installed";
  EXPECT_EQ(shell(kProgram + "completion zsh | zsh -n /dev/stdin").output, "");
}

TEST(Completion, RefusesAnotherShell) {
  const Ended ended = shell(kProgram + "completion fish");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.output, HasSubstr("fish"));
  EXPECT_THAT(ended.output, Not(HasSubstr("complete -o")));
}

}  // namespace
}  // namespace dampline::service
