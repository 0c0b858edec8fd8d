// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "tests/app/program.hpp"

namespace dampline::app {

/// Runs of the built program, and other programs that read them, in one folder.
class RunFilesTest : public testing::Test {
 protected:
  void expect_success(const std::string& arguments) const {
    const auto outcome = program_.run(arguments);
    ASSERT_EQ(outcome.code, 0) << arguments << '\n' << outcome.error;
  }
  void simulate(const std::string& name, const std::string& more = "") const {
    expect_success("simulate --duration 60 --quiet --out " + name + " " + more);
  }
  /// A sliding rig with 1200 N of dry friction: 60 s at 200 Hz, drawn by three sines.
  void write_rig(const std::string& name, double friction_n = 1200.0) const {
    std::mt19937_64 random{7};
    std::normal_distribution<double> noise{0.0, 5.0};
    std::string text = "time_s,deflection_m,force_n\n";
    for (int i = 0; i < 12000; ++i) {
      const double t = i / 200.0;
      double x = 0.0;
      double v = 0.0;
      for (const auto& [hz, size_m] : {std::pair{1.1, 4e-3}, {1.7, 3e-3}, {2.9, 1e-3}}) {
        const double w = 2.0 * std::numbers::pi * hz;
        x += size_m * std::sin(w * t);
        v += size_m * w * std::cos(w * t);
      }
      const double f = friction_n * std::tanh(v / 1e-3) + noise(random);
      text += fmt::format("{:.4f},{:.9f},{:.3f}\n", t, x, f);
    }
    program_.write(name, text);
  }
  /// A command of another program, by the shell in the folder.
  Program::Outcome shell(const std::string& command) const {
    const std::string line =
        "cd '" + program_.path("").string() + "' && { " + command + "; } > .out 2> .err";
    const int status = std::system(line.c_str());  // NOLINT(cert-env33-c) a test of the program
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, program_.read(".out"),
            program_.read(".err")};
  }
  /// Debian's Python, whatever is first in PATH.
  Program::Outcome python(const std::string& code) const {
    program_.write("test.py", "import sys\nsys.path.insert(0, '" DAMPLINE_SOURCE_DIR
                              "/app/analysis')\nsys.dont_write_bytecode = True\n" +
                                  code);
    return shell("/usr/bin/python3 test.py");
  }
  bool has_module(const std::string& name) const {
    return shell("/usr/bin/python3 -c 'import " + name + "'").code == 0;
  }
  Program program_;
};

}  // namespace dampline::app
