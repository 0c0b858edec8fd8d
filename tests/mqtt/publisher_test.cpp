// SPDX-License-Identifier: MIT
// A live run told to Debian's broker, which is late, goes and comes back, and wants certificates.
#include "app/mqtt/publisher.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "app/error.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

int run(const std::string& command) {
  return std::system(command.c_str());  // NOLINT(cert-env33-c) a test of the program
}

class Mqtt : public testing::Test {
 protected:
  void SetUp() override {
    if (run("command -v mosquitto_sub >/dev/null && test -x /usr/sbin/mosquitto") != 0)
      GTEST_SKIP() << "no mosquitto";
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path{testing::TempDir()} / fmt::format("mqtt_{}", info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    port_ = 20000 + ::getpid() % 20000;
    write("broker.conf", fmt::format("listener {} 127.0.0.1\nallow_anonymous true\n", port_));
    config_.mqtt.broker = fmt::format("127.0.0.1:{}", port_);
    config_.record = {"4711", "front/a", "", ""};
  }
  void TearDown() override {
    if (!folder_.empty()) stop_broker();
    std::filesystem::remove_all(folder_);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream{folder_ / name} << text;
  }
  std::string in_folder(const std::string& command) const {
    return fmt::format("cd '{}' && {}", folder_.string(), command);
  }
  void start_broker() const {
    ASSERT_EQ(run(in_folder("{ /usr/sbin/mosquitto -c broker.conf >log 2>&1 & echo $! >pid; }")),
              0);
  }
  void stop_broker() const {
    static_cast<void>(
        run(in_folder("test ! -f pid || { kill -9 $(cat pid); rm pid; } 2>/dev/null")));
  }
  /// What a reader that comes now is told within a second.
  std::string told(const std::string& more = "") const {
    static_cast<void>(
        run(in_folder(fmt::format("mosquitto_sub -h 127.0.0.1 -p {} {} -t 'dampline/#' -v -W 1 "
                                  ">told 2>/dev/null",
                                  port_, more))));
    std::ifstream stream{folder_ / "told"};
    return {std::istreambuf_iterator<char>{stream}, {}};
  }
  static bool comes(const auto& what) {
    for (int i = 0; i < 300 && !what(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
    return what();
  }
  static AlarmChange alarm(const std::string& name, bool active) {
    return {WatchState{name, active, 7800.0, 8000.0, "N", {}}, 1};
  }

  std::filesystem::path folder_;
  int port_{0};
  Config config_;
};

TEST_F(Mqtt, KeepsTheNewestStateTheAlarmsAndTheStatus) {
  start_broker();
  MqttPublisher publisher{config_};
  EXPECT_EQ(publisher.base(), "dampline/4711/front_a");
  ASSERT_TRUE(comes([&] { return publisher.connected(); }));
  publisher.publish("{\"first\": 1}");
  publisher.publish("{\"second\": 2}");
  publisher.tell(alarm("coulomb_below", true), 120.5);
  ASSERT_TRUE(comes([&] { return publisher.waiting() == 0; }));
  EXPECT_THAT(told(),
              AllOf(HasSubstr("dampline/4711/front_a/live {\"second\": 2}"),
                    Not(HasSubstr("first")), HasSubstr("dampline/4711/front_a/status online"),
                    HasSubstr("dampline/4711/front_a/alarm/coulomb_below {\"schema\":"
                              "\"dampline.alarm/1\",\"vehicle\":\"4711\",\"truck\":\"front/a\","
                              "\"name\":\"coulomb_below\",\"state\":\"raised\",\"value\":7800.0,"
                              "\"limit\":8000.0,\"unit\":\"N\",\"time_s\":120.5}")));
  publisher.tell(alarm("coulomb_below", false), 300.0);
  publisher.end("{\"last\": 3}");
  EXPECT_EQ(publisher.waiting(), 0U);
  EXPECT_THAT(told(), AllOf(HasSubstr("live {\"last\": 3}"), HasSubstr("status ended"),
                            HasSubstr("\"state\":\"cleared\""), Not(HasSubstr("raised"))));
}

TEST_F(Mqtt, WaitsForABrokerThatComesLate) {
  MqttPublisher publisher{config_};
  for (const char* name : {"drift", "fault_clipping"}) publisher.tell(alarm(name, true), 1.0);
  publisher.publish("{\"stale\": 1}");
  publisher.publish("{\"newest\": 2}");
  EXPECT_EQ(publisher.waiting(), 2U);
  start_broker();
  ASSERT_TRUE(comes([&] { return publisher.connected() && publisher.waiting() == 0; }));
  EXPECT_THAT(told(), AllOf(HasSubstr("alarm/drift"), HasSubstr("alarm/fault_clipping"),
                            HasSubstr("newest"), Not(HasSubstr("stale"))));
}

TEST_F(Mqtt, WaitsOutAnOutage) {
  start_broker();
  MqttPublisher publisher{config_};
  ASSERT_TRUE(comes([&] { return publisher.connected(); }));
  publisher.publish("{\"before\": 1}");
  stop_broker();
  ASSERT_TRUE(comes([&] { return !publisher.connected(); }));
  publisher.tell(alarm("coulomb_above", true), 9.0);
  publisher.publish("{\"meanwhile\": 2}");
  start_broker();  // without a memory of its own
  ASSERT_TRUE(comes([&] { return publisher.connected() && publisher.waiting() == 0; }));
  EXPECT_THAT(told(), AllOf(HasSubstr("status online"), HasSubstr("alarm/coulomb_above"),
                            HasSubstr("meanwhile")));
}

TEST_F(Mqtt, LeavesItsLastWill) {
  start_broker();
  {
    const MqttPublisher publisher{config_};
    ASSERT_TRUE(comes([&] { return publisher.connected(); }));
    ASSERT_TRUE(comes([&] { return told().find("status online") != std::string::npos; }));
  }  // as a program ends that was killed: without a word
  EXPECT_TRUE(comes([&] { return told().find("status offline") != std::string::npos; }));
}

TEST_F(Mqtt, DropsTheOldestAlarmsAndCountsThem) {
  MqttPublisher publisher{config_};
  for (std::size_t i = 0; i < MqttPublisher::kMostWaiting + 3; ++i)
    publisher.tell(alarm("drift", i % 2 == 0), 1.0);
  EXPECT_EQ(publisher.waiting(), MqttPublisher::kMostWaiting);
  EXPECT_EQ(publisher.dropped(), 3U);
}

TEST_F(Mqtt, EndsAtOnceWhereThereIsNoBroker) {
  config_.mqtt.broker = "192.0.2.1:1883";  // nobody answers there
  const auto start = std::chrono::steady_clock::now();
  {
    MqttPublisher publisher{config_};
    publisher.tell(alarm("drift", true), 1.0);
    publisher.end("{}");
    EXPECT_EQ(publisher.waiting(), 1U);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds{5});
}

TEST_F(Mqtt, KnowsTheBrokerByItsCertificateAndHasOneOfItsOwn) {
  if (run("command -v openssl >/dev/null") != 0) GTEST_SKIP() << "no openssl";
  ASSERT_EQ(run(in_folder(R"sh({
    openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=ca -keyout ca.key -out ca.pem
    openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=other -keyout other.key -out other.pem
    for name in 127.0.0.1 car; do
      openssl req -newkey rsa:2048 -nodes -subj /CN=$name -keyout $name.key -out $name.csr
      echo subjectAltName=IP:127.0.0.1 >$name.ext
      openssl x509 -req -days 2 -in $name.csr -CA ca.pem -CAkey ca.key -CAcreateserial -extfile $name.ext -out $name.pem
    done
    chmod 644 *.key; } >/dev/null 2>&1)sh")),
            0);
  write("broker.conf",
        fmt::format("listener {} 127.0.0.1\nallow_anonymous true\ncafile ca.pem\ncertfile "
                    "127.0.0.1.pem\nkeyfile 127.0.0.1.key\nrequire_certificate true\nuser root\n",
                    port_));
  const auto file = [&](const char* name) { return (folder_ / name).string(); };
  config_.mqtt.ca_file = file("ca.pem");
  start_broker();
  {
    const MqttPublisher nameless{config_};
    std::this_thread::sleep_for(std::chrono::seconds{2});
    EXPECT_FALSE(nameless.connected()) << "without a certificate of its own";
  }
  config_.mqtt.cert_file = file("car.pem");
  config_.mqtt.key_file = file("car.key");
  MqttPublisher publisher{config_};
  publisher.publish("{\"private\": 1}");
  ASSERT_TRUE(comes([&] { return publisher.connected(); }));
  const std::string tls = "--cafile ca.pem --cert car.pem --key car.key";
  EXPECT_TRUE(comes([&] { return told(tls).find("private") != std::string::npos; }));
  config_.mqtt.ca_file = file("other.pem");
  const MqttPublisher deceived{config_};
  std::this_thread::sleep_for(std::chrono::seconds{2});
  EXPECT_FALSE(deceived.connected()) << "the broker's certificate is of another authority";
}

TEST_F(Mqtt, RefusesWhatCannotBe) {
  const auto error_of = [](const Config& config) -> std::string {
    try {
      const MqttPublisher publisher{config};
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* broker :
       {"broker", "broker:", ":1883", "broker:0", "broker:70000", "broker:x"}) {
    config_.mqtt.broker = broker;
    EXPECT_THAT(error_of(config_), HasSubstr("[mqtt] broker")) << broker;
  }
  config_.mqtt.broker = "[::1]:1883";
  config_.mqtt.topic = "a/#";
  EXPECT_THAT(error_of(config_), HasSubstr("[mqtt] topic"));
  config_.mqtt.topic = "fleet/east";
  EXPECT_EQ(error_of(config_), "");
  config_.mqtt.cert_file = "car.pem";
  EXPECT_THAT(error_of(config_), HasSubstr("each needs the other"));
  config_.mqtt.cert_file.clear();
  config_.mqtt.ca_file = "/nowhere.pem";
  EXPECT_THAT(error_of(config_), HasSubstr("/nowhere.pem"));
  config_.mqtt.ca_file.clear();
  config_.mqtt.user = "car";
  config_.mqtt.password_file = "/nowhere";
  EXPECT_THAT(error_of(config_), HasSubstr("/nowhere cannot be read"));
  EXPECT_EQ(open_mqtt(Config{}), nullptr);
}

}  // namespace
}  // namespace dampline::app
