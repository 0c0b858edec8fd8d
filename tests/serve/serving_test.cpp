// SPDX-License-Identifier: MIT
#include "app/serve/serving.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "app/error.hpp"
#include "app/live/run.hpp"
#include "app/record/frames.hpp"
#include "app/run/json.hpp"
#include "app/run/state.hpp"
#include "app/serve/metrics.hpp"
#include "drivers/os/system_clock.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(ServeAddress, IsHostAndPort) {
  EXPECT_TRUE(parse_address("127.0.0.1:9464", "k").loopback);
  EXPECT_TRUE(parse_address("127.8.9.1:0", "k").loopback);
  EXPECT_TRUE(parse_address("[::1]:9464", "k").loopback);
  EXPECT_TRUE(parse_address("localhost:65535", "k").loopback);
  EXPECT_FALSE(parse_address("0.0.0.0:9464", "k").loopback);
  EXPECT_FALSE(parse_address("[::]:9464", "k").loopback);
  EXPECT_FALSE(parse_address("192.0.2.1:9464", "k").loopback);
  for (const char* wrong : {"", ":", "9464", ":9464", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536",
                            "127.0.0.1:-1", "127.0.0.1:http", "::1:9464", "127.0.0.1:999999999999"})
    EXPECT_THROW(static_cast<void>(parse_address(wrong, "k")), UsageError) << wrong;
}

TEST(ServeAddress, TellsAForeignHost) {
  for (const char* own : {"localhost", "localhost:9464", "127.0.0.1", "127.0.0.1:1", "[::1]:9"})
    EXPECT_TRUE(names_loopback(own)) << own;
  for (const char* foreign : {"example.org", "127.0.0.1.example.org", "localhost.example.org",
                              "[::1].example.org", "[::2]", "128.0.0.1", "", "10.0.0.1:9464"})
    EXPECT_FALSE(names_loopback(foreign)) << foreign;
}

Config served(const std::string& address = "127.0.0.1:0") {
  Config config;
  config.serve.address = address;
  return config;
}

TEST(Serving, BeyondTheMachineItWantsAToken) {
  EXPECT_THAT([] { Serving{served("0.0.0.0:0")}; },
              ThrowsMessage<UsageError>(HasSubstr("token_file")));
  Config config = served("0.0.0.0:0");
  config.serve.token_file =
      (std::filesystem::temp_directory_path() / fmt::format("token_{}", ::getpid())).string();
  std::ofstream{config.serve.token_file} << "short\n";
  EXPECT_THAT([&] { Serving{config}; }, ThrowsMessage<UsageError>(HasSubstr("at least 16")));
  std::ofstream{config.serve.token_file} << "0123456789abcdef\n";
  EXPECT_NO_THROW(Serving{config});
  std::filesystem::remove(config.serve.token_file);
}

TEST(Serving, AnAddressThatIsTakenIsAnError) {
  const Serving first{served()};
  const std::string where = first.where();
  const std::string port = where.substr(where.rfind(':') + 1, where.size() - where.rfind(':') - 2);
  EXPECT_THAT([&] { Serving{served("127.0.0.1:" + port)}; },
              ThrowsMessage<RunError>(HasSubstr("in use")));
}

/// A socket that is connected to a server.
class Socket {
 public:
  explicit Socket(const std::string& where) : file_{::socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(where.substr(where.rfind(':') + 1))));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() { ::close(file_); }
  [[nodiscard]] bool send(const std::string& text) const {
    return connected_ && ::send(file_, text.data(), text.size(), MSG_NOSIGNAL) ==
                             static_cast<ssize_t>(text.size());
  }
  /// Nothing more will be sent.
  void end() const { ::shutdown(file_, SHUT_WR); }
  /// At most `most` bytes; empty at the end.
  [[nodiscard]] std::string read(std::size_t most) const {
    std::string out(most, '\0');
    const ssize_t count = ::recv(file_, out.data(), most, 0);
    out.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return out;
  }

 private:
  int file_;
  bool connected_{false};
};

std::string get(const std::string& where, const std::string& path, const std::string& more = "") {
  const Socket socket{where};
  if (!socket.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + more +
                   "\r\n"))
    return "";
  std::string out;
  for (std::string part = socket.read(65536); !part.empty(); part = socket.read(65536)) out += part;
  return out;
}

/// A request that somebody meant well, and what line noise and an enemy make of it.
class Requests {
 public:
  explicit Requests(std::uint64_t seed) : random_{seed} {}
  std::string next() {
    std::string text =
        pick({"GET /live.json HTTP/1.1\r\nHost: localhost\r\n\r\n", "GET /metrics HTTP/1.0\r\n\r\n",
              "GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: text/event-stream\r\n"
              "Last-Event-ID: 7\r\n\r\n",
              "GET /?token=wrong HTTP/1.1\r\nHost: localhost\r\nCookie: token=wrong\r\n"
              "Authorization: Bearer wrong\r\n\r\n",
              "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999\r\n\r\nx",
              "PUT /live.json HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n"});
    for (std::size_t changes = below(6); changes-- > 0;) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>{0, end - 1}(random_);
  }
  std::string pick(std::initializer_list<const char*> list) {
    return list.begin()[below(list.size())];
  }
  void change(std::string& text) {
    const std::size_t at = below(text.size() + 1);
    switch (below(6)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.insert(at,
                    pick({"\r\n", "\n", "\r", "\0", " ", "%", "%00", "%2e%2e/", ":", "\xff\xfe"}));
        break;
      case 2:
        text.resize(at);
        break;
      case 3:
        text.insert(at, std::string(below(40000), "A/%:\r"[below(5)]));
        break;
      case 4:
        text.insert(
            at, pick({"Content-Length: -1\r\n", "Content-Length: 18446744073709551616\r\n",
                      "Host: \r\n", "Transfer-Encoding: chunked\r\n", "Expect: 100-continue\r\n",
                      "Upgrade: websocket\r\n", "Range: bytes=0-,-9\r\n"}));
        break;
      default:
        text += text;
    }
  }
  std::mt19937_64 random_;
};

std::size_t resident_kib() {
  std::ifstream status{"/proc/self/status"};
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stoul(line.substr(6));
  return 0;
}

/// DAMPLINE_REQUESTS: how many; 100,000 take some minutes.
TEST(Serving, NoWrongRequestGetsAnAnswerOrMemory) {
  constexpr std::size_t kMostGrowthKib = 4096;
  const char* asked = std::getenv("DAMPLINE_REQUESTS");
  const std::size_t count = asked == nullptr ? 2000 : std::stoul(asked);
  Config config = served();
  config.serve.token_file =
      (std::filesystem::temp_directory_path() / fmt::format("hostile_{}", ::getpid())).string();
  std::ofstream{config.serve.token_file} << "0123456789abcdef\n";
  const Serving serving{config};
  std::filesystem::remove(config.serve.token_file);
  const auto is_well = [&] {
    return get(serving.where(), "/metrics", "Authorization: Bearer 0123456789abcdef\r\n")
        .starts_with("HTTP/1.1 200");
  };
  ASSERT_TRUE(is_well());
  Requests requests{24};
  std::size_t after_some_kib = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string request = requests.next();
    {
      const Socket socket{serving.where()};
      static_cast<void>(socket.send(request));
      socket.end();
      const std::string reply = socket.read(64);
      ASSERT_FALSE(reply.starts_with("HTTP/1.1 2")) << i << ": " << reply << request.substr(0, 200);
    }
    if (i == count / 10) after_some_kib = resident_kib();
    if (i % 500 == 0) {
      ASSERT_TRUE(is_well()) << i;
    }
  }
  EXPECT_TRUE(is_well());
  EXPECT_LT(resident_kib(), after_some_kib + kMostGrowthKib);
}

/// Slow enough for a writer and for people who look on.
class Unhurried final : public hal::FrameSource {
 public:
  explicit Unhurried(std::int64_t samples)
      : inner_{sim::reference_run(sim::Load::kLaden, 80.0, 5), samples} {}

 private:
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    return inner_.read(out);
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override { return true; }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return inner_.health(); }
  sim::SimulatedSource inner_;
};

Identified run_live(hal::FrameSource& source, Serving* serving) {
  const drivers::SystemClock clock;
  VoidSink sink;
  LiveParts parts{"fake0", &source, &sink, &clock, hal::RunTime::start(clock)};
  LiveOutlets outlets;
  if (serving != nullptr) {
    parts.tap = &serving->tap();
    outlets.turn = [&](const LiveTurn& turn) {
      serving->turn({name_of(turn.state), turn.samples, 0.0});
    };
    outlets.publish = [&](const RunResult& result) { serving->publish(result, to_json(result)); };
  }
  const LiveOptions options{.publish_every_s = 0.2, .realtime_priority = 0};
  return LiveRun{{}, can_channels({}), parts, options, std::move(outlets)}.run();
}

TEST(Serving, WhoLooksOnChangesNoBit) {
  constexpr std::int64_t kSamples = 120 * 300;
  Unhurried alone{kSamples};
  const Identified expected = run_live(alone, nullptr);
  Serving serving{served()};
  std::atomic<bool> stop{false};
  std::atomic<int> answers{0};
  std::vector<std::unique_ptr<Socket>> slow;  // ask for the stream and never read it
  for (int i = 0; i < 20; ++i) {
    slow.push_back(std::make_unique<Socket>(serving.where()));
    ASSERT_TRUE(slow.back()->send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  }
  std::vector<std::jthread> readers;
  for (const char* path : {"/live.json", "/view.json", "/metrics", "/"})
    readers.emplace_back([&, path] {
      while (!stop) answers += get(serving.where(), path).starts_with("HTTP/1.1 200") ? 1 : 0;
    });
  Unhurried watched{kSamples};
  const Identified found = run_live(watched, &serving);
  stop = true;
  readers.clear();
  EXPECT_GT(answers, 100);
  EXPECT_EQ(serving.tap().lost(), 0U);
  ASSERT_NE(expected.sums, nullptr);
  EXPECT_TRUE(encode_state(*found.sums) == encode_state(*expected.sums));
  ASSERT_EQ(found.result.parameters.size(), expected.result.parameters.size());
  for (std::size_t i = 0; i < found.result.parameters.size(); ++i)
    EXPECT_EQ(found.result.parameters[i].value, expected.result.parameters[i].value);
}

RunResult full_result() {
  RunResult out;
  out.trust = Trust::kTrusted;
  out.origin.vehicle = "31 \"80\"\\";
  out.parameters = {{"coulomb", 8300.5, 12.25, "N"}, {"stiffness", 5.26e6, 1e4, "N/m"}};
  out.counts = {{"frames", 900}, {"frames_dropped", 3}, {"blocks", 7}};
  out.faults.list.push_back({"clipping", "frame", 1.0, 2.0, 3.0, "m/s^2", 4, {}});
  out.watched = {{"coulomb_below", true, 8300.5, 9000.0, "N", 12.0}};
  out.live.emplace();
  out.live->state = "identifying";
  out.live->silence_s = std::numeric_limits<double>::quiet_NaN();
  out.lateness = {{4.0, 8.0, 10}, {16.0, 16.5, 20}, {9.0e6, 9.1e6, 2}};
  return out;
}

TEST(Metrics, AreWhatTheResultHolds) {
  const std::string text = metrics_text(full_result(), nullptr);
  EXPECT_THAT(text, HasSubstr("\ndampline_parameter{name=\"coulomb\",unit=\"N\"} 8300.5\n"));
  EXPECT_THAT(text, HasSubstr("\ndampline_parameter_std{name=\"coulomb\",unit=\"N\"} 12.25\n"));
  EXPECT_THAT(text, HasSubstr("\ndampline_frames_total{result=\"dropped\"} 3\n"));
  EXPECT_THAT(text, Not(HasSubstr("blocks")));
  EXPECT_THAT(text, HasSubstr("\ndampline_faults{name=\"clipping\",channel=\"frame\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("\ndampline_alarm{name=\"coulomb_below\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("\ndampline_trust{trust=\"trusted\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("vehicle=\"31 \\\"80\\\"\\\\\""));
  EXPECT_THAT(text, Not(HasSubstr("\ndampline_silence_seconds ")));  // not a number
}

TEST(Metrics, TheHistogramIsCumulativeAndEndsWithAll) {
  const std::string text = metrics_text(full_result(), nullptr);
  EXPECT_THAT(text, HasSubstr("_bucket{le=\"8.192e-06\"} 10\n"));
  EXPECT_THAT(text, HasSubstr("_bucket{le=\"1.6384e-05\"} 10\n"));
  EXPECT_THAT(text, HasSubstr("_bucket{le=\"3.2768e-05\"} 30\n"));
  EXPECT_THAT(text, HasSubstr("_bucket{le=\"8.58993459\"} 30\n"));
  EXPECT_THAT(text, HasSubstr("_bucket{le=\"+Inf\"} 32\n"));
  EXPECT_THAT(text, HasSubstr("lateness_seconds_count 32\n"));
}

TEST(Metrics, EveryLineIsOneOfTheFormat) {
  const std::regex line{
      R"re((# (HELP|TYPE) dampline_[a-z_]+ .+)|(dampline_[a-z_]+(\{([a-z]+="([^"\\\n]|\\.)*",?)+\})? -?[0-9.e+-]+))re"};
  std::istringstream lines{metrics_text(full_result(), nullptr)};
  int count = 0;
  for (std::string text; std::getline(lines, text); ++count)
    EXPECT_TRUE(std::regex_match(text, line)) << text;
  EXPECT_GT(count, 80);
}

}  // namespace
}  // namespace dampline::app
