// SPDX-License-Identifier: MIT
// What lies around the program changes nothing: a language that writes a decimal comma, pipes that
// nobody writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <map>
#include <string>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

TEST(Language, WithADecimalCommaChangesNoByte) {
  const Program program;
  // The C library never frees the parts of LOCPATH: a sanitized program is not to look for leaks.
  const std::string places = "LOCPATH=\"$PWD/locale\" ASAN_OPTIONS=detect_leaks=0 ";
  const auto shell = [&](const std::string& command) {
    return program.run("--version", "(mkdir -p locale && " + places + command + ") &&");
  };
  ASSERT_EQ(shell("localedef -f UTF-8 -i de_DE locale/de_DE.UTF-8").code, 0);
  ASSERT_EQ(shell("env LC_ALL=de_DE.UTF-8 printf %.1f 2,5 | grep -qx 2,5").code, 0)
      << "the language is not there";
  std::map<std::string, std::string> seen;
  for (const std::string language : {"C", "de_DE.UTF-8"}) {
    const std::string with = places + "LC_ALL=" + language;
    ASSERT_EQ(program.run("simulate --duration 20 --quiet --force --out run.log", with).code, 0);
    ASSERT_EQ(program.run("simulate --duration 20 --quiet --force --out run.csv", with).code, 0);
    std::string all = program.read("run.log") + program.read("run.csv");
    for (const char* record : {"run.log", "run.csv"}) {
      const auto outcome =
          program.run(std::string{"identify "} + record + " --out o --force --json", with);
      ASSERT_EQ(outcome.code, 0) << outcome.error;
      all += outcome.output;
      for (const char* file : {"state.dls", "curve.csv", "run.toml", "report.html", "phase.json"})
        all += program.read(std::string{"o/"} + file);
    }
    all += program.run("report o", with).output + program.read("o/report.html");
    seen[language] = all;
  }
  EXPECT_TRUE(seen["C"] == seen["de_DE.UTF-8"]);
}

TEST(NamedPipe, ThatNobodyWritesIsWaitedForAsARecordOnly) {
  const Program program;
  ASSERT_EQ(::mkfifo(program.path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(program.run("identify pipe --out o", "timeout -s INT 1").code, 124) << "until a signal";
  EXPECT_FALSE(program.exists("o"));
  const auto config = program.run("identify pipe --config pipe --out o", "timeout 20");
  EXPECT_EQ(config.code, 2);
  EXPECT_THAT(config.error, HasSubstr("pipe: found no key"));
  for (const char* verb :
       {"merge pipe --out m", "export pipe --out e", "compare pipe pipe", "report pipe"}) {
    const auto outcome = program.run(verb, "timeout 20");
    EXPECT_THAT(outcome.code, testing::AnyOf(1, 2)) << verb << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("dampline: error: pipe: ")) << verb;
  }
}

}  // namespace
}  // namespace dampline::app
