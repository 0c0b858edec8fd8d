// SPDX-License-Identifier: MIT
// What comes through a pipe: its checksum, and signals before it says anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

class PipeRun : public testing::Test {
 protected:
  [[nodiscard]] bool shell(const std::string& command) const {
    const std::string all = "cd '" + program_.path("").string() + "' && " + command + " 2> .shell";
    return std::system(all.c_str()) == 0;  // NOLINT(cert-env33-c) oracles are programs
  }
  Program program_;
};

TEST_F(PipeRun, HasTheChecksumOfItsBytes) {
  ASSERT_EQ(program_.run("simulate --duration 20 --seed 1 --quiet --out a.log").code, 0);
  ASSERT_TRUE(shell("gzip -k a.log && sha256sum a.log > plain.txt && sha256sum a.log.gz > gz.txt"));
  const std::string plain = program_.read("plain.txt").substr(0, 64);
  const std::string packed = program_.read("gz.txt").substr(0, 64);
  ASSERT_EQ(program_.run("identify - --quiet --out run", "cat a.log |").code, 0);
  EXPECT_THAT(program_.read("run/parameters.json"), HasSubstr(plain));
  ASSERT_EQ(program_.run("identify - --quiet --force --out run < a.log").code, 0);
  EXPECT_THAT(program_.read("run/parameters.json"), HasSubstr(plain));
  ASSERT_EQ(program_.run("identify - --quiet --force --out run", "cat a.log.gz |").code, 0);
  EXPECT_THAT(program_.read("run/parameters.json"), HasSubstr(packed));
}

TEST_F(PipeRun, ASignalBeforeItsFirstLineLeavesNothing) {
  for (const std::string verb : {"identify", "explain"}) {
    for (const std::string signal : {"INT", "TERM"}) {
      EXPECT_FALSE(shell("sleep 1 | timeout -s " + signal + " 0.5 " + DAMPLINE_BINARY_DIR +
                         "/dampline " + verb + " - --out run"));
      EXPECT_FALSE(program_.exists("run")) << verb << signal;
      EXPECT_TRUE(shell("! ls -a | grep partial")) << verb << signal;
    }
  }
}

}  // namespace
}  // namespace dampline::app
