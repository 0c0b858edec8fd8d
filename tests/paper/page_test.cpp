// SPDX-License-Identifier: MIT
#include "app/verify/page.hpp"

#include <gtest/gtest.h>

namespace dampline::app {
namespace {

TEST(VerifyPage, HoldsTablesListsAndHeadings) {
  EXPECT_EQ(html_of_markdown("### T & 1\n\n| a | b |\n|--|--|\n| 1 \\| 2 | < 3 |\n\n- note\nend\n"),
            "<h3>T &amp; 1</h3>\n"
            "<table>\n<tr><th> a </th><th> b </th></tr>\n"
            "<tr><td> 1 | 2 </td><td> &lt; 3 </td></tr>\n</table>\n"
            "<ul>\n<li>note</li>\n</ul>\n<p>end</p>\n");
  EXPECT_EQ(html_of_markdown("| a |\n|--|"), "<table>\n<tr><th> a </th></tr>\n</table>\n");
}

TEST(VerifyPage, LetsFiguresPass) {
  const std::string figure = "<figure><div>\n<svg></svg>\n\n</div></figure>\n";
  EXPECT_EQ(html_of_markdown("| a |\n" + figure + "end\n"),
            "<table>\n<tr><th> a </th></tr>\n</table>\n" + figure + "<p>end</p>\n");
}

TEST(VerifyPage, IsWholeByItself) {
  const std::string page = whole_page("A < B", "<p>body</p>\n");
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_NE(page.find("<title>A &lt; B</title>"), std::string::npos);
  EXPECT_NE(page.find("<p>body</p>"), std::string::npos);
  EXPECT_NE(page.find("name=\"viewport\""), std::string::npos);
  EXPECT_EQ(page.find("href="), std::string::npos);
}

}  // namespace
}  // namespace dampline::app
