// SPDX-License-Identifier: MIT
// A run directory from somebody else: nothing in it is more than text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/report/assets.hpp"
#include "app/run/directory.hpp"
#include "tests/app/fake_result.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// For gnuplot, a shell, a browser, an XML reader and a terminal.
const std::vector<std::string> kHostile{"x' 0); system(\"touch pwned\"); set ytics (",
                                        "`touch pwned` $(touch pwned) ; touch pwned |touch pwned",
                                        "\"><script>alert(1)</script><img src=x onerror=alert(1)>",
                                        "]]></svg><!-- ' onload='alert(1)",
                                        "\x1b]0;pwned\x07\x1b[2J\xc2\x9b"
                                        "31m"};

class HostileRun : public testing::Test {
 protected:
  using json = nlohmann::json;

  HostileRun() {
    RunResult result = fake_result();
    make_live(result);
    result.events = {{0.5, "marker_on", 0, 1}};
    result.excluded = {{1.0, 2.0, "gap"}};
    RunDirectory directory{program_.path("run"), false};
    stage_files({result, write_run_toml(Config{}, {{"a.log", "record", 12, std::string(64, 'f')}}),
                 "state"},
                directory);
    directory.commit();
  }
  /// Draws it again; whatever comes of it, nothing was done but that.
  void draw(const std::string& what) {
    const auto outcome = program_.run("report run");
    EXPECT_THAT(outcome.code, AnyOf(0, 1)) << what << outcome.error;
    EXPECT_FALSE(program_.exists("pwned")) << what;
    EXPECT_FALSE(program_.exists("run/pwned")) << what;
    const std::string page = program_.read("run/report.html");
    for (const char* bad : {"<script>alert", "<img", "]]></svg>", "\x1b"})
      EXPECT_THAT(page, Not(HasSubstr(bad))) << what;
    expect_own_scripts(page, what);
    for (const char* bad : {"\x1b", "\x07", "\xc2\x9b"})
      EXPECT_THAT(outcome.error, Not(HasSubstr(bad))) << what;
    drawn_ += outcome.code == 0 ? 1 : 0;
  }
  /// The numbers of the plots, from which no text can break out, and the page's two scripts, to
  /// which its policy keeps it.
  static void expect_own_scripts(std::string_view page, const std::string& what) {
    const std::string scripts = page_scripts();
    const std::size_t own = page.find(scripts);
    if (own == std::string_view::npos) return;  // not drawn: the page of the fixture is none
    std::string_view rest = page.substr(0, own);
    EXPECT_THAT(page.substr(own + scripts.size()), Not(HasSubstr("<script"))) << what;
    EXPECT_THAT(rest, HasSubstr("default-src 'none'")) << what;
    constexpr std::string_view kData = "<script type=\"application/json\">";
    for (std::size_t at = rest.find("<script"); at != rest.npos; at = rest.find("<script")) {
      rest.remove_prefix(at);
      ASSERT_TRUE(rest.starts_with(kData)) << what;
      const std::size_t end = rest.find('<', kData.size());
      ASSERT_TRUE(rest.substr(end).starts_with("</script>")) << what;
      EXPECT_TRUE(json::accept(rest.substr(kData.size(), end - kData.size()))) << what;
      rest.remove_prefix(end);
    }
  }
  /// Each text of the file by itself, by each of the hostile ones.
  void spoil_json(const std::string& name) {
    const json whole = json::parse(program_.read("run/" + name));
    std::vector<json::json_pointer> texts;
    const std::function<void(const json&, const json::json_pointer&)> walk =
        [&](const json& node, const json::json_pointer& at) {
          if (node.is_string()) texts.push_back(at);
          if (!node.is_structured()) return;
          for (const auto& [key, value] : node.items())
            walk(value,
                 node.is_array() ? at / static_cast<std::size_t>(std::stoul(key)) : at / key);
        };
    walk(whole, json::json_pointer{});
    for (const auto& at : texts) {
      const auto index = static_cast<std::size_t>(&at - texts.data());
      json spoilt = whole;
      spoilt[at] = kHostile[index % kHostile.size()];
      program_.write("run/" + name, spoilt.dump(1, ' ', false, json::error_handler_t::replace));
      draw(name + " " + at.to_string());
    }
    program_.write("run/" + name, whole.dump(1));
  }
  /// Each cell of the first two lines.
  void spoil_csv(const std::string& name) {
    const std::string whole = program_.read("run/" + name);
    const std::size_t end = whole.find('\n', whole.find('\n') + 1);
    std::size_t number = 0;
    for (std::size_t at = 0; at < end;) {
      const std::size_t stop = std::min(whole.find_first_of(",\n", at), whole.size());
      std::string spoilt = whole;
      spoilt.replace(at, stop - at, kHostile[number++ % kHostile.size()]);
      program_.write("run/" + name, spoilt);
      draw(name);
      at = stop + 1;
    }
    program_.write("run/" + name, whole);
  }

  const Program program_;
  int drawn_{0};
};

TEST_F(HostileRun, IsTextInEveryFieldOfEveryFile) {
  for (const auto& entry : std::filesystem::directory_iterator{program_.path("run")}) {
    const std::string name = entry.path().filename();
    if (name.ends_with(".json")) spoil_json(name);
    if (name.ends_with(".csv")) spoil_csv(name);
  }
  const std::string toml = program_.read("run/run.toml");
  for (const std::string& text : kHostile) {
    program_.write("run/run.toml", toml + "# " + text + "\n");
    draw("run.toml");
  }
  EXPECT_GT(drawn_, 10) << "some were drawn";
}

TEST_F(HostileRun, NamesOfEventsAndReasonsAreDrawnAsTheyAre) {
  program_.write("run/events.csv",
                 "time_s,event,line,value\n1.5,x' 0); system(\"touch pwned\"),0,0\n");
  program_.write("run/excluded.csv", "start_s,end_s,reason\n1,2,<b>&\n");
  draw("events");
  EXPECT_EQ(drawn_, 1);
  const std::string page = program_.read("run/report.html");
  EXPECT_THAT(page, HasSubstr("x' 0); system(&quot;touch pwned&quot;)"));
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;"));
}

#if !defined(DAMPLINE_SANITIZED)  // a sanitizer brings calls of its own
TEST(Program, StartsNoShellAndNothingByAName) {
  const Program program;
  ASSERT_EQ(std::system(("nm -D --undefined-only '" DAMPLINE_BINARY_DIR "/dampline' > '" +
                         program.path("symbols").string() + "'")
                            .c_str()),
            0);
  const std::string symbols = program.read("symbols");
  ASSERT_THAT(symbols, HasSubstr("write"));
  // posix_spawn() starts what [alarm] on_alarm of a live run names, and sbatch for `archive
  // --slurm`; a record's replay starts nothing.
  for (const char* call :
       {" posix_spawnp", " popen", " system@", " execl", " execvp", " fork", " vfork"})
    EXPECT_THAT(symbols, Not(HasSubstr(call)));
}
#endif

}  // namespace
}  // namespace dampline::app
