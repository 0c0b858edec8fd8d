// SPDX-License-Identifier: MIT
// The built program: what foreign bytes it lets through to a terminal, how large a file it
// believes, what it overwrites, and how it is linked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/text/quote.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Clears the screen, sets a title, and does so by the controls of eight bits.
const std::string kEscape =
    "\x1b[2J\x1b]0;x\x07\x7f\xc2\x9b"
    "2J\x9b"
    "2J";

/// Nothing of it but line ends and tabs.
bool has_controls(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f) return true;
    const bool second = i > 0 && static_cast<unsigned char>(text[i - 1]) >= 0xc3;
    if (byte >= 0x80 && byte < 0xa0 && !second && i > 0 &&
        (static_cast<unsigned char>(text[i - 1]) < 0x80 || text[i - 1] == '\xc2'))
      return true;
  }
  return false;
}

TEST(Printable, EscapesControlsAndLeavesLetters) {
  EXPECT_EQ(drivers::printable("a\x1b[b\x7f"), "a\\x1B[b\\x7F");
  EXPECT_EQ(drivers::printable("\xc2\x9b"
                               "2J"),
            "\\xC2\\x9B2J");
  EXPECT_EQ(drivers::printable("\x9b"
                               "2J \xff \xc3"),
            "\\x9B2J \\xFF \\xC3");
  EXPECT_EQ(drivers::printable("8351 ± 14 µs, 10⁻³, Größe, 𝛼"), "8351 ± 14 µs, 10⁻³, Größe, 𝛼");
  EXPECT_EQ(drivers::printable("one\ntwo"), "one\\x0Atwo");
  EXPECT_EQ(drivers::printable("one\ntwo", true), "one\ntwo");
}

TEST(ForeignText, ReachesNoTerminalAsItIs) {
  const Program program;
  const std::string dbc = "VERSION \"\"\nBO_ 1 A: 8 N\n SG_ " + kEscape + " x\n";
  program.write("a.dbc", dbc);
  program.write("a.toml", "[input.can]\ndbc = \"a.dbc\"\n");
  program.write("b.toml", "\"" + kEscape + "\" = 1\n");
  program.write("c.toml", "[car]\nmoving_mass_kg = \"\\u001b[2J\\u009b\"\n");
  program.write("d.toml", "[input.can]\nframe_accel = \"\\u001b[2J.\\u009b\"\n");
  program.write("a.log", "(1.0) can0 " + kEscape + "\n");
  program.write("b.log", "(1.0) can0 0C1#0011\n");
  program.write("a.csv", "time_s," + kEscape + "\n0,1\n1,2\n");
  program.write("b.csv", "time_s,force_n,deflection_m\n0,1," + kEscape + "\n1,2,3\n");
  program.write(kEscape + ".csv", "time_s\n0\n");
  for (const std::string& command :
       {std::string{"identify b.log --config a.toml"}, std::string{"config check b.toml"},
        std::string{"config check c.toml"}, std::string{"identify b.log --config d.toml"},
        std::string{"identify a.log"}, std::string{"identify a.csv"}, std::string{"identify b.csv"},
        "identify '" + kEscape + ".csv'", "identify '" + kEscape + ".none'",
        "report '" + kEscape + "'", "config check '" + kEscape + "'", "export '" + kEscape + "'"}) {
    const auto outcome = program.run(command);
    EXPECT_THAT(outcome.code, testing::AnyOf(1, 2)) << command;
    EXPECT_FALSE(has_controls(outcome.error)) << command << ": " << outcome.error;
    EXPECT_FALSE(has_controls(outcome.output)) << command;
  }
}

TEST(ForeignFile, IsNamedWithItsLine) {
  const Program program;
  program.write("run.csv", "time_s,force_n,deflection_m\n0,1,2\n1,x,3\n");
  EXPECT_THAT(program.run("identify run.csv").error, HasSubstr("run.csv:3"));
  program.write("run.log", "(1.000000) can0 0C1#0011\n(2.000000) can0 0C1#00zz\n");
  EXPECT_THAT(program.run("identify run.log").error, HasSubstr("run.log:2"));
  program.write("car.toml", "[car]\nmoving_mass_kg = \n");
  EXPECT_THAT(program.run("config check car.toml").error, HasSubstr("car.toml:2"));
  program.write("car.toml", "[input.can]\ndbc = \"a.dbc\"\n");
  program.write("a.dbc", "VERSION \"\"\nBO_ 1 A: 8 N\n SG_ broken\n");
  EXPECT_THAT(program.run("identify run.log --config car.toml").error, HasSubstr("a.dbc:3"));
}

TEST(ForeignFile, ThatNeverEndsIsRefused) {
  const Program program;
  program.write("car.toml", "[input.can]\ndbc = \"/dev/zero\"\n");
  const auto dbc = program.run("identify x.log --config car.toml");
  EXPECT_THAT(dbc.code, testing::AnyOf(1, 2));
  const auto config = program.run("config check /dev/zero");
  EXPECT_EQ(config.code, 2);
  EXPECT_THAT(config.error, HasSubstr("larger than 1048576 bytes"));
}

TEST(ErrorsOfSeveralLines, AreReadAsLinesAndPassForNoOtherMessage) {
  const Program program;
  program.write("rig.csv", "time_s,deflection_m,force\n0,0,0\n0.01,0,0\n");
  EXPECT_THAT(program.run("identify rig.csv").error,
              HasSubstr("\n  [input.columns]\n  force_n = "));
  const auto outcome = program.run("identify 'no\ndampline: error: forged'");
  EXPECT_THAT(outcome.error, Not(HasSubstr("\ndampline:")));
}

TEST(Overwriting, NeedsForce) {
  const Program program;
  for (const char* file : {"run.log", "run.csv", "s.dbc", "s.toml", "truth.csv"})
    program.write(file, "years of work\n");
  for (const char* files :
       {"--out run.log", "--out run.csv", "--out new.log --dbc s.dbc",
        "--out new.log --config-out s.toml", "--out new.log --truth truth.csv"}) {
    const auto outcome = program.run("simulate --duration 2 --quiet " + std::string{files});
    EXPECT_EQ(outcome.code, 2) << files;
    EXPECT_THAT(outcome.error, HasSubstr("exists already; --force replaces it")) << files;
  }
  for (const char* file : {"run.log", "run.csv", "s.dbc", "s.toml", "truth.csv"})
    EXPECT_EQ(program.read(file), "years of work\n");
  EXPECT_EQ(program.run("simulate --duration 2 --quiet --force --out run.log --dbc s.dbc").code, 0);
  EXPECT_THAT(program.read("run.log"), HasSubstr("can0"));
  EXPECT_THAT(program.read("s.dbc"), HasSubstr("VERSION"));
  EXPECT_EQ(program.run("simulate --duration 2 --quiet --out /dev/null").code, 0);
}

TEST(Overwriting, FollowsNoLinkThatSomebodyLaid) {
  const Program program;
  program.write("victim", "untouched\n");
  std::filesystem::create_symlink("victim", program.path("run.log"));
  EXPECT_EQ(program.run("simulate --duration 2 --quiet --force --out run.log").code, 0);
  EXPECT_EQ(program.read("victim"), "untouched\n");
}

TEST(Binary, IsHardened) {
  const Program program;
  const std::string binary = "'" DAMPLINE_BINARY_DIR "/dampline'";
  ASSERT_EQ(std::system(("(readelf -W -h -l -d " + binary + "; nm -D " + binary + ") > '" +
                         program.path("elf").string() + "'")
                            .c_str()),
            0);
  const std::string elf = program.read("elf");
  EXPECT_THAT(elf, AllOf(HasSubstr("GNU_RELRO"), HasSubstr("BIND_NOW"), HasSubstr("DYN")));
  const std::size_t stack = elf.find("GNU_STACK");
  ASSERT_NE(stack, std::string::npos);
  EXPECT_THAT(elf.substr(stack, elf.find('\n', stack) - stack), Not(HasSubstr("RWE")));
#if !defined(DAMPLINE_SANITIZED) && defined(NDEBUG)
  EXPECT_THAT(elf, AllOf(HasSubstr("__stack_chk_fail"), HasSubstr("_chk@")));
#endif
}

}  // namespace
}  // namespace dampline::app
