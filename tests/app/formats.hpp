// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "app/run/state.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {

/// Bytes of a state.dls, shown by their number and a hash where a test fails.
struct StateBytes {
  std::string bytes;
  [[nodiscard]] std::size_t size() const { return bytes.size(); }
  bool operator==(const StateBytes&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const StateBytes& state) {
    return out << state.size() << " bytes, hash " << std::hash<std::string>{}(state.bytes);
  }
};

/// The sums of a state alone: the same record in another format, or without a date, is another
/// segment.
inline StateBytes sums_of(const std::string& state) {
  const auto sums = std::make_unique<Statistics>();
  decode_state(state, "a state", *sums);
  return {encode_state(*sums)};
}

/// Records of one drive in many formats, in the folder of a program.
class FormatTest : public testing::Test {
 protected:
  [[nodiscard]] StateBytes state_of(const std::string& source,
                                    const std::string& before = "") const {
    const auto outcome =
        program_.run("identify --quiet --no-report --force --out run " + source, before);
    EXPECT_EQ(outcome.code, 0) << source << ": " << outcome.error;
    return sums_of(program_.read("run/state.dls"));
  }
  /// Runs a command of the shell in the folder; false: it failed, or there is no such program.
  [[nodiscard]] bool shell(const std::string& command) const {
    const std::string all = "cd '" + program_.path("").string() + "' && " + command + " 2> .shell";
    return std::system(all.c_str()) == 0;  // NOLINT(cert-env33-c) oracles are programs
  }
  /// False: a module is missing, or the script failed; .shell says why.
  [[nodiscard]] bool python(const std::string& script) const {
    program_.write("script.py", script);
    return shell("/usr/bin/python3 script.py");
  }
  Program program_;
};

}  // namespace dampline::app
