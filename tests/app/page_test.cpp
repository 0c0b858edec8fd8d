// SPDX-License-Identifier: MIT
#include "app/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "app/report/html.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"
#include "tests/app/fake_result.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Provenance some_provenance() { return {"0.1.0", {{"<run>.log", "record", 12, "abcd"}}}; }

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++found;
  return found;
}

TEST(Page, HoldsEverythingAndNeedsNothingElse) {
  const std::string page = make_page(fake_result(), some_provenance(), "[car]\nx = \"<b>\"\n");
  EXPECT_THAT(page, AllOf(HasSubstr("8 351 N"), HasSubstr("5.262 ± 0.016 MN/m"),
                          HasSubstr("&lt;run&gt;.log"), HasSubstr("not observable"),
                          HasSubstr("&lt;b&gt;")));
  for (const char* outside : {"<link", "src=", "url(http", "<img", "@import"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  EXPECT_EQ(count(page, "<script>"), 2U) << "uPlot, and what uses it";
  EXPECT_EQ(count(page, "<script type=\"application/json\">"), 14U) << "the numbers of each plot";
  EXPECT_EQ(count(page, "<script"), 16U);
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_EQ(count(page, "<svg"), 14U);
  for (const char* label :
       {"damping force F (kN)", "relative velocity v (mm/s)", "time in the record (s)",
        "stiffness (MN/m)", "coulomb (kN)", "F sign v (kN)", "relative deflection y (mm)",
        "density (s/mm)", "y (mm)", "v (mm/s)", "period 0.37 s"})
    EXPECT_THAT(page, HasSubstr(label));
}

TEST(Page, DrawsHowLateTheFramesOfALiveRunWere) {
  RunResult result = fake_result();
  make_live(result);
  const std::string page = make_page(result, some_provenance(), "");
  EXPECT_THAT(page, HasSubstr("238 µs / 301 µs / 557 µs / 1900 µs / 5600 µs"));
  EXPECT_EQ(count(page, "<svg"), 15U);
  for (const char* label : {"stamp to its result (µs)", ">frames<", "p50 238 µs", "p90 301 µs",
                            "p99 557 µs", "p99.9 1900 µs", "largest 5600 µs"})
    EXPECT_THAT(page, HasSubstr(label));
}

/// What a screen reader, a dark screen and a validator ask for.
TEST(Page, HasPlotsForEverybody) {
  RunResult result = fake_result();
  make_live(result);
  const std::string page = make_page(result, some_provenance(), "");
  const std::size_t plots = count(page, "<svg");
  EXPECT_EQ(count(page, "</svg>"), plots);
  for (const char* part : {"role=\"img\"", "aria-label=\"", "<title>", "<desc id=\""})
    EXPECT_GE(count(page, part), plots) << part;
  std::set<std::string> ids;
  std::size_t all = 0;
  for (std::size_t at = page.find(" id=\""); at != std::string::npos;
       at = page.find(" id=\"", at + 1))
    ids.insert(page.substr(at + 5, page.find('"', at + 5) - at - 5)), ++all;
  EXPECT_EQ(ids.size(), all) << "an id stands twice";
  EXPECT_EQ(all, 3 * plots);
  for (const char* rule : {"prefers-color-scheme: dark", "@media print", "currentColor"})
    EXPECT_THAT(page, HasSubstr(rule));
  const std::size_t drawn = page.find("<svg");
  const std::string drawings = page.substr(drawn, page.rfind("</svg>") - drawn);
  EXPECT_THAT(drawings, AllOf(Not(HasSubstr("fill=\"#")), Not(HasSubstr("stroke=\"#")),
                              Not(HasSubstr("nan")), Not(HasSubstr("inf "))))
      << "colours have names, and nothing is drawn nowhere";
}

TEST(Page, DrawsLatenessOfNothingAtAll) {
  RunResult result = fake_result();
  result.live = LiveFigures{};
  result.lateness = {{0.0, 0.001, 3}};
  const std::string page = make_page(result, some_provenance(), "");
  EXPECT_EQ(count(page, "<svg"), 15U);
}

TEST(Page, DrawsACurveOfWhichNothingIsResolved) {
  RunResult result = fake_result();
  for (Parameter& p : result.parameters)
    if (p.name == "law_width") p.value = 1.0;
  const std::string page = make_page(result, some_provenance(), "");
  EXPECT_EQ(count(page, "<svg"), 14U);
}

TEST(Page, ShowsAMethodThatIsNotToBeTrustedInGreyWithTheReason) {
  const std::string html = make_page(fake_result(), some_provenance(), "");
  EXPECT_THAT(html, AllOf(HasSubstr("class=\"grey\"><td role=\"cell\">Fokker-Planck, weak form"),
                          HasSubstr("&lt;comb&gt;: 14.2 dB, limit 6 dB"),
                          HasSubstr("<tr role=\"row\"><td role=\"cell\">known input"),
                          HasSubstr("-0.7 %")));
}

TEST(Page, SaysThatDeviationsAreLowerBounds) {
  RunResult result = fake_result();
  EXPECT_THAT(make_page(result, some_provenance(), ""), Not(HasSubstr("lower bounds")));
  result.std_is_lower_bound = true;
  EXPECT_THAT(make_page(result, some_provenance(), ""), HasSubstr("lower bounds"));
}

TEST(Page, StandsForAResultThatHasOnlyParameters) {
  RunResult result;
  result.kind = "rig";
  result.headline = std::string{"h"};
  const std::string page = make_page(result, {}, "");
  EXPECT_THAT(page, AllOf(HasSubstr("Nothing was left out"), HasSubstr("</html>")));
}

TEST(Quantity, ShowsTheDigitsThatTheDeviationSupports) {
  EXPECT_EQ(format_quantity(8351.234, 14.3).value, "8351");
  EXPECT_EQ(format_quantity(8351.234, 14.3).std, "14");
  EXPECT_EQ(format_quantity(0.0016234, 0.00021).value, "0.00162");
  EXPECT_EQ(format_quantity(5262345.0, 16000.0).value, "5 262 000");
  EXPECT_EQ(format_quantity(-20.3935, 0.5).value, "-20.39");
  EXPECT_EQ(format_quantity(1.5, 0.0).std, "");
  EXPECT_EQ(format_quantity(std::nan(""), 1.0).value, "unknown");
  EXPECT_EQ(format_count(1234567), "1 234 567");
  EXPECT_EQ(format_count(12), "12");
  EXPECT_EQ(format_duration(59.0), "59 s");
  EXPECT_EQ(format_duration(300.0), "5 min");
  EXPECT_EQ(format_duration(3725.0), "1 h 2 min");
}

TEST(Summary, ListsParametersFitAndWhatWasLeftOut) {
  EXPECT_THAT(
      summarize(fake_result()),
      AllOf(HasSubstr("coulomb"), HasSubstr("8351 ± 14"), HasSubstr("N/m"), HasSubstr("rrse 0.106"),
            HasSubstr("6.1 s (gap)"), HasSubstr("not observable"),
            HasSubstr("not to be trusted here: the input is not white: <comb>: 14.2 dB, limit 6")));
}

}  // namespace
}  // namespace dampline::app
