// SPDX-License-Identifier: MIT
// The published figures, held against the papers' own text where that is present: DAMPLINE_PAPERS,
// or shared/papers beside the project.
#include "app/verify/printed/printed.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <stdexcept>
#include <string>

#include "tests/drivers/temporary_file.hpp"

namespace dampline::app {
namespace {

/// The text of the scanned paper that holds `phrase`; empty where there is none.
std::string paper_with(const std::string& phrase) {
  namespace fs = std::filesystem;
  const char* set = std::getenv("DAMPLINE_PAPERS");
  const fs::path folder =
      set != nullptr ? fs::path{set} : fs::path{DAMPLINE_SOURCE_DIR} / ".." / "shared" / "papers";
  if (!fs::is_directory(folder)) return {};
  for (const auto& entry : fs::directory_iterator{folder}) {
    const std::string text = test::content_of(entry.path());
    if (text.find(phrase) != std::string::npos) return text;
  }
  return {};
}

/// One space between words; "!" before a digit is a minus, elsewhere a footnote's mark.
std::string plain(std::string text) {
  text = std::regex_replace(text, std::regex{"!([0-9.])"}, "-$1");
  text = std::regex_replace(text, std::regex{"!"}, "");
  return std::regex_replace(text, std::regex{"\\s+"}, " ");
}

std::string joined(const PrintedRow& row) {
  std::string out;
  for (const std::string& figure : row.figures)
    out += (out.empty() ? "" : " ") + (figure == "-" ? std::string{"*"} : figure);
  return out;
}

// Each row's figures stand in the scan side by side, after the table's heading and within it.
TEST(Printed, GhanemAndRomeoIsThePapersText) {
  const std::string text = plain(paper_with("wavelet-based approach for model"));
  if (text.empty()) GTEST_SKIP() << "no papers";
  for (const PrintedTable& table : ghanem_romeo()) {
    const std::string heading = "Table " + table.name + table.caption.substr(0, 12);
    const std::size_t from = text.find(heading);
    ASSERT_NE(from, std::string::npos) << heading;
    const std::string part = text.substr(from, 1000);
    for (const PrintedRow& row : table.rows)
      EXPECT_NE(part.find(joined(row)), std::string::npos) << heading << ": " << joined(row);
  }
}

// Columns of the scan are torn apart; each figure must stand in it as often as the tables have it.
// What the scan misreads is named here.
TEST(Printed, KisilowskiAndUrbanskiIsThePapersText) {
  std::string text = plain(paper_with("passive"));
  if (text.empty()) GTEST_SKIP() << "no papers";
  const auto repair = [&](const std::string& scanned, const std::string& printed) {
    ASSERT_NE(text.find(scanned), std::string::npos) << scanned;
    for (std::size_t at = 0; (at = text.find(scanned, at)) != std::string::npos;)
      text.replace(at, scanned.size(), printed);
  };
  repair("0~00000", "0.00000");
  repair("0.003 1 ", "0.0031 ");
  repair("0.03 1 ", "0.031 ");
  repair("l-54810", "1.54810");
  repair("o*ooo", "0.000");
  for (const PrintedTable& table : kisilowski_urbanski()) {
    if (table.columns.front() != "XP") continue;
    for (const PrintedRow& row : table.rows) {
      for (const std::string& figure : row.figures)
        EXPECT_NE(text.find(figure), std::string::npos) << table.name << ": " << figure;
    }
  }
  for (const char* level : {"7562 N", "9150 N", "3 154 N", "2720 N"})
    EXPECT_NE(text.find(level), std::string::npos) << level;
}

TEST(Printed, PhaseMappingsIsThePapersText) {
  const std::string text = paper_with("PHASE TRAJECTORIES MAPPINGS");
  if (text.empty()) GTEST_SKIP() << "no papers";
  for (const char* figure : {"\\omega_{r,1} = 0.69", "\\omega_{r,2} = 0.12", "\\omega_{r,3} = 0.16",
                             "P_1 = 0.1; 0.5; 1", "\\omega = 0.5; 1; 2", "P_0 = -0.1; 0.1; 1"})
    EXPECT_NE(text.find(figure), std::string::npos) << figure;
  EXPECT_EQ(printed_table(phase_mappings(), "inputs").at("P0", "1").value, -0.1);
}

TEST(Printed, IsReadByRowAndColumn) {
  EXPECT_EQ(printed_table(ghanem_romeo(), "8").at("Estimates", "k2").text, "14 900");
  EXPECT_EQ(printed_table(ghanem_romeo(), "8").at("Estimates", "k2").value, 14900.0);
  EXPECT_THROW(static_cast<void>(printed_table(ghanem_romeo(), "19")), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(printed_table(ghanem_romeo(), "8").at("COV", "k9")),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(printed_table(ghanem_romeo(), "2").at("Duffing", "c(3)")),
               std::invalid_argument);
  for (const auto* paper : {&ghanem_romeo(), &kisilowski_urbanski(), &phase_mappings()}) {
    for (const PrintedTable& table : *paper) {
      for (const PrintedRow& row : table.rows) {
        ASSERT_EQ(row.figures.size(), table.columns.size()) << table.name << ", " << row.name;
        for (const std::string& figure : row.figures) {
          if (figure == "-") continue;
          EXPECT_NO_THROW(Printed{figure}) << table.name << ": " << figure;
        }
      }
    }
  }
}

}  // namespace
}  // namespace dampline::app
