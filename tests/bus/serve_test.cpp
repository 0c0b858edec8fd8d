// SPDX-License-Identifier: MIT
// A live run on a bus with a crowd that looks on: it is seen, it tells its alarm, and it changes
// nothing.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"

namespace dampline::bus {
namespace {

using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint16_t kPort = 9464;

/// A GET that was sent; what comes is read when somebody asks.
class Reader {
 public:
  explicit Reader(const std::string& path) : file_{::socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kPort);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::string text =
        "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    sent_ =
        ::connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 &&
        ::send(file_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { ::close(file_); }
  [[nodiscard]] bool sent() const noexcept { return sent_; }
  /// To the end of the connection.
  [[nodiscard]] std::string read() const {
    std::string out;
    std::string part(65536, '\0');
    for (ssize_t n = 0; (n = ::recv(file_, part.data(), part.size(), 0)) > 0;)
      out.append(part.data(), static_cast<std::size_t>(n));
    return out;
  }

 private:
  int file_;
  bool sent_{false};
};

TEST(TimeTravelNightlyServe, IsSeenByManyAndDisturbedByNone) {
  const Folder folder;
  const auto told = folder / "told";
  {
    std::ofstream script{folder / "tell"};
    script << "#!/bin/sh\necho \"$@\" > '" << told.string() << "'\n";
  }
  std::filesystem::permissions(folder / "tell", std::filesystem::perms::owner_all);
  std::ofstream{folder / "car.toml"}
      << "[alarm]\ncoulomb_above_n = 1000.0\nhold_s = 0.0\non_alarm = [\""
      << (folder / "tell").string() << "\", \"workshop\"]\n";
  VirtualCan bus;
  LiveProgram live{folder,
                   bus.name(),
                   folder / "live",
                   {"--config", folder / "car.toml", "--serve", "127.0.0.1:9464", "--prom-file",
                    folder / "dampline.prom", "--publish-every", "2"}};
  std::vector<std::unique_ptr<Reader>> streams;  // never read
  for (int i = 0; i < 20; ++i) {
    streams.push_back(std::make_unique<Reader>("/events"));
    ASSERT_TRUE(streams.back()->sent());
  }
  Child simulate{simulate_command(bus.name(), 90.0, 10), folder.path()};
  std::this_thread::sleep_for(seconds{20});
  EXPECT_THAT(Reader{"/live.json"}.read(), HasSubstr("Collecting motion for the first estimate"));
  for (int i = 0; i < 60; ++i) {
    std::this_thread::sleep_for(seconds{1});
    EXPECT_THAT(Reader{"/view.json"}.read(), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_THAT(Reader{"/metrics"}.read(),
              AllOf(HasSubstr("\ndampline_parameter{name=\"coulomb\",unit=\"N\"} 8"),
                    HasSubstr("\ndampline_alarm{name=\"coulomb_above\"} 1\n"),
                    HasSubstr("\ndampline_page_faults_total{kind=\"minor\"} 0\n"),
                    HasSubstr("\ndampline_page_samples_lost_total 0\n")));
  EXPECT_THAT(Reader{"/healthz"}.read(), HasSubstr("\r\n\r\nidentifying\n"));
  EXPECT_THAT(Reader{"/view.json"}.read(), HasSubstr("\"alarm_raised\""));
  EXPECT_THAT(read_file(folder / "dampline.prom"), HasSubstr("\ndampline_parameter{"));
  EXPECT_THAT(read_file(told), StartsWith("workshop coulomb_above raised 8"));
  ASSERT_EQ(simulate.wait().status, 0);
  std::this_thread::sleep_for(seconds{1});
  const nlohmann::json result = live.stop();
  EXPECT_EQ(result.at("counts").at("frames_processed"), 81'000);
  EXPECT_EQ(result.at("live").at("minor_faults"), 0);
  EXPECT_EQ(result.at("live").at("major_faults"), 0);
  EXPECT_EQ(result.at("live").at("cycle_slips"), 0);
  EXPECT_THAT(read_file(folder / "live" / "events.csv"), HasSubstr("alarm_raised"));
  identify(folder / "live" / "blackbox", folder / "again");
  EXPECT_TRUE(read_file(folder / "live" / "state.dls") ==
              read_file(folder / "again" / "state.dls"));
}

}  // namespace
}  // namespace dampline::bus
