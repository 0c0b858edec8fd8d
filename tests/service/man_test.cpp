// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include "tests/service/shell.hpp"

namespace dampline::service {
namespace {

const std::string kPage = DAMPLINE_SOURCE_DIR "/app/man/dampline.1";
const std::string kDampline = "'" DAMPLINE_BINARY_DIR "/dampline' ";

/// All that a pattern's first group finds.
std::set<std::string> all(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex regex{pattern};
  for (std::sregex_iterator it{text.begin(), text.end(), regex}; it != std::sregex_iterator{};
       ++it) {
    found.insert((*it)[1]);
  }
  return found;
}

std::string help(const std::string& verb) { return shell(kDampline + verb + " --help").output; }

std::set<std::string> verbs() {
  const std::string text = help("");
  return all(text.substr(text.find("Subcommands:")), "\n  ([a-z]+) ");
}

/// What the page says of one verb.
std::string section(const std::string& page, const std::string& verb) {
  const std::size_t begin = page.find("\n.Ss dampline " + verb + "\n");
  if (begin == std::string::npos) return "";
  const std::size_t end = std::min(page.find("\n.Ss ", begin + 1), page.find("\n.Sh ", begin));
  return page.substr(begin, end - begin);
}

TEST(ManPage, HasAllVerbsAndNoOther) {
  const std::string page = text_of(kPage);
  EXPECT_EQ(all(page, "\n\\.Ss dampline ([a-z]+)"), verbs());
}

TEST(ManPage, HasAllFlagsAndNoOther) {
  const std::string page = text_of(kPage);
  for (const std::string& verb : verbs()) {
    std::set<std::string> flags = all(help(verb), "\n  (?:-[a-z],)?--([a-z0-9-]+)");
    flags.erase("help");
    EXPECT_EQ(all(section(page, verb), "\n\\.It Fl -([a-z0-9-]+)"), flags) << verb;
  }
}

TEST(ManPage, IsRightInTheEyesOfMandoc) {
  if (!has_program("mandoc")) GTEST_SKIP() << "mandoc is not installed";
  // The standard error tells of mandoc's own database, which a bare system has not filled. Which
  // other manuals there are is the system's matter, too.
  const Ended lint = shell("mandoc -T lint -W style '" + kPage +
                           "' 2>/dev/null | grep -v 'referenced manual not found'");
  EXPECT_EQ(lint.output, "");
}

TEST(ManPage, IsRightInTheEyesOfGroff) {
  if (!has_program("groff")) GTEST_SKIP() << "groff is not installed";
  const Ended render = shell("groff -ww -mandoc -Tascii '" + kPage + "' >/dev/null");
  EXPECT_EQ(render.status, 0);
  EXPECT_EQ(render.output, "");
}

}  // namespace
}  // namespace dampline::service
