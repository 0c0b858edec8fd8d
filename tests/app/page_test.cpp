// SPDX-License-Identifier: MIT
#include "app/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "app/report/gnuplot.hpp"
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

bool has_gnuplot() { return run_child({"gnuplot", "--version"}, "").started; }

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++found;
  return found;
}

TEST(Page, HoldsEverythingAndNeedsNothingElse) {
  const Page page = make_page(fake_result(), some_provenance(), "[car]\nx = \"<b>\"\n");
  EXPECT_THAT(page.html,
              AllOf(HasSubstr("8 351 N"), HasSubstr("5 262 000"), HasSubstr("&lt;run&gt;.log"),
                    HasSubstr("not observable"), HasSubstr("&lt;b&gt;")));
  for (const char* outside : {"<script", "<link", "src=", "url(http", "<img", "@import"})
    EXPECT_THAT(page.html, Not(HasSubstr(outside)));
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot here: the drawings were not looked at";
  EXPECT_EQ(page.warning, "");
  EXPECT_EQ(count(page.html, "<svg"), 7U);
  for (const char* label :
       {"damping force F (kN)", "relative velocity v (mm/s)", "time in the record (s)",
        "stiffness (MN/m)", "coulomb (kN)", "F sign v (kN)", "relative deflection y (mm)",
        "density (s/mm)", "y (mm)", "v (mm/s)", "period 0.37 s"})
    EXPECT_THAT(page.html, HasSubstr(label));
}

TEST(Page, DrawsHowLateTheFramesOfALiveRunWere) {
  RunResult result = fake_result();
  make_live(result);
  const Page page = make_page(result, some_provenance(), "");
  EXPECT_THAT(page.html, HasSubstr("238 µs / 301 µs / 557 µs / 1900 µs / 5600 µs"));
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot here: the drawings were not looked at";
  EXPECT_EQ(page.warning, "");
  EXPECT_EQ(count(page.html, "<svg"), 8U);
  for (const char* label : {"stamp to its result (µs)", ">frames<", "p50 238 µs", "p90 301 µs",
                            "p99 557 µs", "p99.9 1900 µs", "largest 5600 µs"})
    EXPECT_THAT(page.html, HasSubstr(label));
}

TEST(Page, DrawsLatenessOfNothingAtAll) {
  RunResult result = fake_result();
  result.live = LiveFigures{};
  result.lateness = {{0.0, 0.001, 3}};
  const Page page = make_page(result, some_provenance(), "");
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot here: the drawings were not looked at";
  EXPECT_EQ(page.warning, "");
  EXPECT_EQ(count(page.html, "<svg"), 8U);
}

TEST(Page, DrawsACurveOfWhichNothingIsResolved) {
  RunResult result = fake_result();
  for (Parameter& p : result.parameters)
    if (p.name == "law_width") p.value = 1.0;
  const Page page = make_page(result, some_provenance(), "");
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot here: the drawings were not looked at";
  EXPECT_EQ(page.warning, "");
  EXPECT_EQ(count(page.html, "<svg"), 7U);
}

TEST(Page, ShowsAMethodThatIsNotToBeTrustedInGreyWithTheReason) {
  const std::string html = make_page(fake_result(), some_provenance(), "").html;
  EXPECT_THAT(html, AllOf(HasSubstr("<tr class=\"grey\"><td>Fokker-Planck, weak form"),
                          HasSubstr("&lt;comb&gt;: 14.2 dB, limit 6 dB"),
                          HasSubstr("<tr><td>known input"), HasSubstr("-0.7 %")));
}

TEST(Page, IsWrittenWithoutGnuplotAndSaysWhatToInstall) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nonexistent", 1);
  const Page page = make_page(fake_result(), some_provenance(), "");
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(page.warning, HasSubstr("gnuplot-nox"));
  EXPECT_THAT(page.html,
              AllOf(HasSubstr("gnuplot-nox"), HasSubstr("5 262 000"), HasSubstr("</html>")));
}

TEST(Page, SaysThatDeviationsAreLowerBounds) {
  RunResult result = fake_result();
  EXPECT_THAT(make_page(result, some_provenance(), "").html, Not(HasSubstr("lower bounds")));
  result.std_is_lower_bound = true;
  EXPECT_THAT(make_page(result, some_provenance(), "").html, HasSubstr("lower bounds"));
}

TEST(Page, StandsForAResultThatHasOnlyParameters) {
  RunResult result;
  result.kind = "rig";
  result.headline = "h";
  const Page page = make_page(result, {}, "");
  EXPECT_THAT(page.html, AllOf(HasSubstr("Nothing was left out"), HasSubstr("</html>")));
}

TEST(Child, FeedsAndReadsAProgram) {
  const ChildResult result = run_child({"cat"}, std::string(300'000, 'x') + "end");
  EXPECT_TRUE(result.started);
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.output.size(), 300'003U);
  EXPECT_FALSE(run_child({"no-such-program-here"}, "").started);
  EXPECT_EQ(run_child({"sh", "-c", "exit 3"}, "").status, 3);
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
