// SPDX-License-Identifier: MIT
#pragma once
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/run/state.hpp"
#include "tests/run_files/run_test.hpp"

namespace dampline::app {

/// A day of one truck in several logs, and what the program makes of them.
class SegmentsTest : public RunFilesTest {
 protected:
  /// 60 s each of one run, in logs/NAME0.log and so on.
  void make_logs(std::size_t count, const std::string& more = "",
                 const std::string& name = "logs/part") const {
    constexpr std::size_t kLineFrames = 900;  // of 3 channels at 300 Hz, in a second
    expect_success(
        fmt::format("simulate --duration {} --quiet --out all.log {}", 60 * count, more));
    const std::string all = program_.read("all.log");
    std::filesystem::create_directories(program_.path(name).parent_path());
    std::size_t begin = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t end = begin;
      for (std::size_t line = 0; line < 60 * kLineFrames; ++line) end = all.find('\n', end) + 1;
      program_.write(fmt::format("{}{}.log", name, i), all.substr(begin, end - begin));
      begin = end;
    }
  }
  /// Runs r0, r1, ... of logs that make_logs() made; their names with blanks between.
  std::vector<std::string> identify_logs(std::size_t count, const std::string& more = "") const {
    std::vector<std::string> runs;
    for (std::size_t i = 0; i < count; ++i) {
      runs.push_back(fmt::format("r{}", i));
      expect_success(
          fmt::format("identify logs/part{0}.log --quiet --no-report --out r{0} {1}", i, more));
    }
    return runs;
  }
  static std::string words(const std::vector<std::string>& list) {
    std::string out;
    for (const std::string& word : list) out += word + " ";
    return out;
  }
  /// What must not depend on how the merge was made.
  std::string bytes_of(const std::string& run) const {
    EXPECT_TRUE(program_.exists(run + "/state.dls")) << run;
    return program_.read(run + "/state.dls") + program_.read(run + "/curve.csv") +
           program_.read(run + "/convergence.csv");
  }
  /// By a merge of its own.
  std::string merged_bytes(const std::string& arguments) const {
    const auto outcome =
        program_.run("merge --quiet --no-report --force --out merged " + arguments);
    EXPECT_EQ(outcome.code, 0) << arguments << '\n' << outcome.error;
    return bytes_of("merged");
  }
  void expect_refused(const std::string& arguments, const std::string& why) const {
    const auto outcome = program_.run("merge --no-report --out refused " + arguments);
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_THAT(outcome.error, testing::HasSubstr(why));
    EXPECT_FALSE(program_.exists("refused"));
  }
  StateAbout about_of(const std::string& state) const {
    const auto sums = std::make_unique<Statistics>();
    return load_state(program_.path(state), *sums);
  }
  /// The same sums, said to be of something else.
  void rewrite(const std::string& from, const std::string& to, const auto& change) const {
    const auto sums = std::make_unique<Statistics>();
    StateAbout about = load_state(program_.path(from), *sums);
    change(about, *sums);
    program_.write(to, encode_state(*sums, about));
  }
};

}  // namespace dampline::app
