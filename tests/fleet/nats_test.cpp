// SPDX-License-Identifier: MIT
// Loggers, a leaf server, the hub and a collector: Debian's servers with the configuration of
// app/service/nats, TLS and certificates included, on loopback.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "app/error.hpp"
#include "app/fleet/forward.hpp"
#include "app/fleet/spool.hpp"
#include "tests/fleet/logger.hpp"
#include "tests/fleet/segments.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Milliseconds = std::chrono::milliseconds;

constexpr Milliseconds kPatience{3000};

/// Some states of three segments of a logger, in order.
const std::vector<SegmentFile>& states() {
  static const std::vector<SegmentFile> kStates = Logger{Logger::config(20.0, 6.0)}.drive(50.0);
  return kStates;
}
constexpr int kStepsAnHour = 6;
constexpr int kHours = 3;
/// States of an hour each, one every ten minutes, of a car that moves for 20 s in each of these.
/// `jumps`: of its clock, beside.
std::vector<SegmentFile> hours_of_driving(std::uint64_t seed, std::vector<Logger::Jump> jumps) {
  constexpr double kMovingS = 20.0;
  constexpr int kSteps = kHours * kStepsAnHour;
  for (int i = 1; i < kSteps; ++i)
    jumps.push_back({kMovingS * i, 3600.0 / kStepsAnHour - kMovingS});
  return Logger{Logger::config(3600.0, 600.0), seed}.drive(kMovingS * kSteps, jumps);
}
const std::vector<SegmentFile>& driven_states() {
  static const std::vector<SegmentFile> kStates = hours_of_driving(5, {});
  return kStates;
}
/// The same of one whose clock jumped.
const std::vector<SegmentFile>& jumped_states() {
  static const std::vector<SegmentFile> kStates =
      hours_of_driving(6, {{70.0, -5000.0}, {190.0, 40'000.0}});
  return kStates;
}

/// Said to be of another car, and some hours later.
SegmentFile of(const SegmentFile& state, const std::string& vehicle, int hours = 0) {
  static const auto kSums = std::make_unique<Statistics>();
  SegmentFile out;
  out.about = decode_state(state.bytes, "state", *kSums);
  out.about.segment.vehicle = vehicle;
  out.about.segment.start_ns += hours * 3'600'000'000'000;
  out.bytes = encode_state(*kSums, out.about);
  return out;
}

class Nats : public SegmentsTest {
 protected:
  void SetUp() override {
    if (shell("command -v nats-server && command -v openssl").code != 0)
      GTEST_SKIP() << "no nats-server or openssl";
    if (!fleet::has_nats()) GTEST_SKIP() << "built without libnats";
    port_ = 20000 + 4 * (::getpid() % 3000);  // four a test, below those that the kernel hands out
    ASSERT_EQ(
        shell("'" DAMPLINE_SOURCE_DIR "/app/service/nats/certificates' pki hub=localhost collector "
              "car-4711 car-4712 depot")
            .code,
        0);
    configure("hub.conf", "");
    configure("store.conf", "");
    configure("cars.conf", "");
    configure("leaf.conf", "");
    start("hub", port_);
    make_stream();
  }
  void TearDown() override {
    for (const char* server : {"hub", "leaf", "leaf2", "collector"}) stop(server);
  }
  /// A file of app/service/nats with this test's addresses and places.
  void configure(const std::string& file, const std::string& more, const std::string& to = "") {
    const auto outcome = shell(
        fmt::format("sed -e 's|0.0.0.0:4222|127.0.0.1:{0}|; s|0.0.0.0:7422|127.0.0.1:{1}|; "
                    "s|\"127.0.0.1:4222\"|\"127.0.0.1:{2}\"|; s|hub.example:7422|localhost:{1}|; "
                    "s|/etc/dampline/nats|pki|; s|/var/lib/nats|js|; {3}' "
                    "'" DAMPLINE_SOURCE_DIR "/app/service/nats/{4}' > {5}",
                    port_, port_ + 1, to == "leaf2.conf" ? port_ + 3 : port_ + 2, more, file,
                    to.empty() ? file : to));
    ASSERT_EQ(outcome.code, 0) << outcome.error;
  }
  /// Until it answers.
  void start(const std::string& server, int port) {
    const std::string command = server == "hub" ? "'" DAMPLINE_SOURCE_DIR "/app/service/nats/hub' ."
                                                : fmt::format("nats-server -c {}.conf", server);
    ASSERT_EQ(shell(fmt::format("{0} >{1}.log 2>&1 & echo $! >{1}.pid", command, server)).code, 0);
    ASSERT_TRUE(comes([&] { return answers(port); })) << program_.read(server + ".log");
  }
  /// Until its ports are free; one that was killed, and that nobody waited for, has no program.
  void stop(const std::string& server) const {
    static_cast<void>(
        shell(fmt::format("test ! -f {0}.pid || {{ read -r pid <{0}.pid; kill -9 $pid; rm {0}.pid; "
                          "while test -e /proc/$pid/exe; do sleep .01; done; }}",
                          server)));
  }
  static bool answers(int port) {
    const int handle = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool yes =
        ::connect(handle, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    ::close(handle);
    return yes;
  }
  std::string hub() const { return fmt::format("tls://localhost:{}", port_); }
  std::string leaf() const { return fmt::format("nats://127.0.0.1:{}", port_ + 2); }
  std::string leaf2() const { return fmt::format("nats://127.0.0.1:{}", port_ + 3); }
  static std::string as(const std::string& name) {
    return fmt::format(" --ca pki/ca.pem --cert pki/{0}.pem --key pki/{0}.key ", name);
  }
  fleet::NatsAddress address_as(const std::string& name) const {
    const std::string stem = program_.path("pki/" + name).string();
    return {hub(), program_.path("pki/ca.pem").string(), stem + ".pem", stem + ".key", ""};
  }
  json collect(const std::string& more = "") const {
    const auto outcome =
        program_.run("collect --db fleet.sqlite --json " + hub() + as("collector") + more);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return outcome.code == 0 ? json::parse(outcome.output) : json{};
  }
  void make_stream() const { static_cast<void>(collect()); }
  /// A spool as a logger leaves it.
  void put(const std::string& folder, const SegmentFile& state) const {
    std::filesystem::create_directories(program_.path(folder));
    program_.write(folder + "/" + fleet::segment_name(state.about.segment) + ".dls", state.bytes);
  }
  /// Within a minute: servers start and find each other late on a loaded machine.
  static bool comes(const auto& what) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes{1};
    while (!what()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(Milliseconds{20});
    }
    return true;
  }
  int port_{0};
};

TEST_F(Nats, ACarSpeaksForItselfAlone) {
  start("leaf", port_ + 2);
  put("own", of(states().back(), "4711"));
  put("foreign", of(states().back(), "4712"));
  // By its own server, and without one.
  EXPECT_TRUE(comes([&] {
    return program_.run("forward own --again --once --nats " + leaf()).code == 0;
  })) << program_.read(".stderr")
      << program_.read("leaf.log") << program_.read("hub.log");
  EXPECT_EQ(program_.run("forward own --again --once --nats " + hub() + as("car-4711")).code, 0);
  const auto by_leaf = program_.run("forward foreign --once --nats " + leaf());
  EXPECT_EQ(by_leaf.code, 1);
  EXPECT_THAT(by_leaf.error, HasSubstr("1 states wait: no stream takes it"));
  fleet::NatsSender thief{address_as("car-4711"), "4711"};
  EXPECT_THAT(thief.send({"4712", "front", 1, 0}, "x", Milliseconds{300}),
              HasSubstr("Permissions Violation"));
  // Nothing of what the hub keeps can be read, removed or asked for.
  EXPECT_THROW((fleet::NatsReceiver{address_as("car-4711"), "spy", false}), RunError);
  // Without a certificate, with a stranger's, to a server of another name: no connection.
  EXPECT_EQ(program_.run("forward own --again --once --nats " + hub() + " --ca pki/ca.pem").code,
            1);
  ASSERT_EQ(shell("'" DAMPLINE_SOURCE_DIR "/app/service/nats/certificates' other car-4711").code,
            0);
  EXPECT_EQ(program_
                .run("forward own --again --once --nats " + hub() +
                     " --ca pki/ca.pem --cert other/car-4711.pem --key other/car-4711.key")
                .code,
            1);
  EXPECT_EQ(program_
                .run(fmt::format("forward own --again --once --nats tls://127.0.0.1:{}", port_) +
                     as("car-4711"))
                .code,
            1);
  const json all = collect();
  EXPECT_EQ(all.at("states_new"), 1);
  EXPECT_EQ(all.at("segments"), 1);
}

TEST_F(Nats, AStateOfAnotherCarIsRefusedWhateverItsSubject) {
  fleet::NatsSender car{address_as("car-4711"), "4711"};
  const SegmentFile foreign = of(states().back(), "4712");
  EXPECT_EQ(car.send({"4711", "front", 5, 0}, foreign.bytes, kPatience), "");
  EXPECT_EQ(car.send({"4711", "front", 6, 0}, "no state", kPatience), "");
  const json all = collect();
  EXPECT_EQ(all.at("segments"), 0);
  ASSERT_EQ(all.at("refused").size(), 2U);
  EXPECT_THAT(all.at("refused").at(0).at("reason").get<std::string>(),
              HasSubstr("came on subject dl.state.4711.front.5, expected dl.state.4712.front."));
}

using NatsNightly = Nats;

TEST_F(NatsNightly, AKilledCollectorGoesOn) {
  constexpr int kCars = 120;
  for (int i = 0; i < kCars; ++i) put("spool", of(states().back(), "4711", i));
  ASSERT_EQ(program_.run("forward spool --once --nats " + hub() + as("car-4711")).code, 0);
  for (const char* after : {"0.05", "0.1", "0.2", "0.3"})
    static_cast<void>(program_.run("collect --db fleet.sqlite --quiet " + hub() + as("collector"),
                                   fmt::format("timeout -s KILL {}", after)));
  // What a killed one had in hand comes again when the hub has waited for it, or is asked to.
  EXPECT_EQ(collect("--again").at("segments"), kCars);
  const json known = collect();
  EXPECT_EQ(known.at("states_new"), 0);
  EXPECT_EQ(known.at("states_known"), 0) << "confirmed ones do not come again";
  std::filesystem::remove(program_.path("fleet.sqlite"));
  EXPECT_EQ(collect().at("states_new"), kCars) << "a new database gets all";
  EXPECT_TRUE(merged_bytes("spool") == merged_bytes("fleet.sqlite"));
}

/// Without `hub`, a nats-server that was killed drops a seventh to a third of what it confirms.
TEST_F(Nats, AKilledHubKeepsWhatItConfirms) {
  constexpr int kSegments = 100;
  fleet::NatsSender car{address_as("car-4711"), "4711"};
  std::mt19937 random{7};
  const auto send = [&](std::size_t state, double share) {
    for (int i = 0; i < kSegments; ++i) {
      if (std::uniform_real_distribution<>{0.0, 1.0}(random) > share) continue;
      const SegmentFile file = of(driven_states()[state], "4711", i);
      ASSERT_TRUE(
          comes([&] { return car.send(file.about.segment, file.bytes, kPatience).empty(); }));
    }
  };
  ASSERT_EQ(driven_states()[3].about.segment, driven_states()[0].about.segment);
  send(0, 0.7);
  send(1, 0.7);
  send(2, 0.7);
  stop("hub");
  start("hub", port_);
  send(3, 1.0);
  static_cast<void>(collect());
  EXPECT_EQ(shell(fmt::format("sqlite3 fleet.sqlite 'select count(*) from state where seq = {}'",
                              driven_states()[3].about.sequence))
                .output,
            fmt::format("{}\n", kSegments));
}

TEST_F(Nats, AFullSpoolSendsWhatItCouldKeep) {
  constexpr int kSegments = 40;
  SpoolSettings settings;
  settings.folder = program_.path("spool").string();
  settings.keep_mib = 1;
  settings.reserve_free_mib = 0;
  fleet::Spool spool{settings, {"4711", "front", "", ""}};
  stop("hub");
  fleet::Forwarder forwarder{{settings.folder}, address_as("car-4711"), false};
  for (int i = 0; i < kSegments; ++i) {
    const SegmentFile state = of(states().back(), "4711", i);
    spool.put(state.about.segment, state.bytes);
    if (i % 7 == 0) {
      EXPECT_FALSE(forwarder.round(Milliseconds{200}).error.empty());
    }
  }
  EXPECT_GT(spool.health().dropped, 0U);
  start("hub", port_);
  EXPECT_TRUE(comes([&] { return forwarder.round(kPatience).error.empty(); }));
  EXPECT_EQ(collect().at("segments"), kSegments - spool.health().dropped);
  EXPECT_TRUE(merged_bytes("spool") == merged_bytes("fleet.sqlite"));
}

/// 200 loggers behind two leaf servers, in virtual time: each step is ten minutes of all.
class Fleet : public Nats {
 protected:
  static constexpr int kLoggers = 200;
  struct Car {
    std::unique_ptr<fleet::Spool> spool;
    std::unique_ptr<fleet::Forwarder> forwarder;
    std::vector<SegmentFile> states;
  };
  void make_cars() {
    for (int i = 0; i < kLoggers; ++i) {
      const std::string vehicle = fmt::format("car {}", i);
      SpoolSettings settings;
      settings.folder = program_.path(fmt::format("spools/{}", i)).string();
      settings.reserve_free_mib = 0;
      Car car;
      car.spool = std::make_unique<fleet::Spool>(settings, RecordLabels{vehicle, "front", "", ""});
      car.forwarder = forwarder(i, false);
      for (const SegmentFile& state : i % 10 == 7 ? jumped_states() : driven_states())
        car.states.push_back(of(state, vehicle));
      cars_.push_back(std::move(car));
    }
  }
  std::unique_ptr<fleet::Forwarder> forwarder(int i, bool again) const {
    return std::make_unique<fleet::Forwarder>(
        std::vector{program_.path(fmt::format("spools/{}", i)).string()},
        fleet::NatsAddress{i % 2 == 0 ? leaf() : leaf2(), "", "", "", ""}, again);
  }
  /// Every logger writes its next state; some of them look whether they can send.
  void step(int number, double share) {
    for (Car& car : cars_) {
      const auto at = static_cast<std::size_t>(number);
      if (at < car.states.size())
        car.spool->put(car.states[at].about.segment, car.states[at].bytes);
    }
    for (Car& car : cars_)
      if (std::uniform_real_distribution<>{0.0, 1.0}(random_) < share)
        static_cast<void>(car.forwarder->round(Milliseconds{300}));
  }
  void start_leaf(const std::string& name, int port) {
    start(name, port);
    fleet::NatsSender probe{{fmt::format("nats://127.0.0.1:{}", port), "", "", "", ""}, "probe"};
    ASSERT_TRUE(comes([&] {
      return !answers(port_) || probe.send({"probe", name, 1, 0}, "x", Milliseconds{500}).empty();
    })) << program_.read(name + ".log");
  }
  std::vector<Car> cars_;
  std::mt19937 random_{4};
};

using FleetNightly = Fleet;

TEST_F(FleetNightly, MergesToTheBytesOfItsFilesWhateverFails) {
  configure("cars.conf",
            "s|\"car-4711\"|\"depot\"|; s|dl.state.4711.>|dl.state.>|; s|_INBOX.4711.>|_INBOX.>|");
  configure("leaf.conf", "s|car-4711|depot|");
  configure("leaf.conf", "s|car-4711|depot|; s|server_name: \"depot\"|server_name: \"two\"|",
            "leaf2.conf");
  stop("hub");
  start("hub", port_);
  start_leaf("leaf", port_ + 2);
  start_leaf("leaf2", port_ + 3);
  make_cars();
  int now = 0;
  for (; now < 3; ++now) step(now, 0.7);
  static_cast<void>(collect());
  stop("hub");  // what is new replaces what was not sent
  for (int i = 0; i < kStepsAnHour; ++i) step(now++, 0.05);
  stop("leaf2");
  step(now++, 0.05);
  start("hub", port_);
  start_leaf("leaf2", port_ + 3);
  step(now++, 0.5);
  // Late and doubled: an old state of a segment after a newer one was collected, and all again.
  static_cast<void>(collect());
  fleet::NatsSender late{{leaf(), "", "", "", ""}, "late"};
  for (int i = 0; i < kLoggers; i += 3) {
    const SegmentFile& old = cars_[static_cast<std::size_t>(i)].states.front();
    ASSERT_TRUE(comes([&] { return late.send(old.about.segment, old.bytes, kPatience).empty(); }));
  }
  for (int i = 0; i < kLoggers; i += 10) static_cast<void>(forwarder(i, true)->round(kPatience));
  for (; now < kHours * kStepsAnHour + 4; ++now) step(now, 0.3);
  stop("leaf");
  start_leaf("leaf", port_ + 2);
  for (Car& car : cars_)
    ASSERT_TRUE(comes([&] { return car.forwarder->round(kPatience).error.empty(); }));
  const json last = collect();
  std::size_t segments = 0;
  for (const Car& car : cars_) segments += last_states(car.states).size();
  EXPECT_EQ(last.at("segments"), segments);
  EXPECT_TRUE(merged_bytes("spools --jobs 2") == merged_bytes("fleet.sqlite --jobs 2"));
  EXPECT_EQ(collect("--again").at("states_later"), 0);
}

}  // namespace
}  // namespace dampline::app
