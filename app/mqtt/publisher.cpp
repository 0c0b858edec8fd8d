// SPDX-License-Identifier: MIT
#include "app/mqtt/publisher.hpp"

#include <fmt/format.h>
#include <mosquitto.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

constexpr int kConfirmed = 1;  // quality of service: at least once
constexpr bool kRetained = true;
constexpr int kTurnMs = 50;
constexpr std::chrono::seconds kAgain{1};
constexpr std::chrono::seconds kAgainMost{30};

/// A level of a topic.
std::string level(const std::string& text) {
  return text.empty() ? "unknown" : without(text, "/+#");
}

struct Broker {
  std::string host;
  int port{0};
};

/// "host:1883", "[::1]:1883".
Broker parse_broker(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  Broker out;
  if (colon != std::string::npos && colon > 0) {
    out.host = text.substr(0, colon);
    if (out.host.front() == '[' && out.host.back() == ']')
      out.host = out.host.substr(1, out.host.size() - 2);
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data() + colon + 1, end, out.port);
    if (error == std::errc{} && at == end && out.port > 0 && out.port < 65536 && !out.host.empty())
      return out;
  }
  throw UsageError{fmt::format("[mqtt] broker: found {}, expected HOST:PORT, \"127.0.0.1:1883\"",
                               drivers::quote(text))};
}

std::string first_line(const std::string& file, const char* key) {
  std::ifstream stream{file};
  std::string line;
  if (!std::getline(stream, line) || line.empty())
    throw UsageError{fmt::format("[mqtt] {}: {} cannot be read or has no first line", key, file)};
  return line;
}

const char* or_null(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

MqttPublisher::MqttPublisher(const Config& config)
    : base_{fmt::format("{}/{}/{}", config.mqtt.topic, level(config.record.vehicle),
                        level(config.record.truck))},
      vehicle_{config.record.vehicle},
      truck_{config.record.truck},
      client_{nullptr, mosquitto_destroy} {
  const Broker broker = parse_broker(config.mqtt.broker);
  if (config.mqtt.topic.empty() || config.mqtt.topic.find_first_of("+#") != std::string::npos)
    throw UsageError{fmt::format("[mqtt] topic: found {}, expected a topic without + and #",
                                 drivers::quote(config.mqtt.topic))};
  prepare(config.mqtt);
  thread_ = std::jthread{
      [this, broker](const std::stop_token& stop) { work(stop, broker.host, broker.port); }};
}

/// Connects, talks for as long as that goes, waits, and again.
void MqttPublisher::work(const std::stop_token& stop, const std::string& host, int port) {
  constexpr int kAliveS = 30;
  std::chrono::seconds wait = kAgain;
  while (!stop.stop_requested()) {
    const int code = mosquitto_connect_async(client_.get(), host.c_str(), port, kAliveS);
    while (code == MOSQ_ERR_SUCCESS && !stop.stop_requested() &&
           mosquitto_loop(client_.get(), kTurnMs, 1) == MOSQ_ERR_SUCCESS)
      if (connected()) wait = kAgain;
    std::unique_lock lock{mutex_};
    confirmed_.wait_for(lock, stop, wait, [] { return false; });
    wait = std::min(2 * wait, kAgainMost);
  }
}

void MqttPublisher::prepare(const MqttSettings& settings) {
  mosquitto_lib_init();
  client_.reset(mosquitto_new(nullptr, true, this));
  if (!client_) throw RunError{"MQTT: no client can be made"};
  mosquitto* const client = client_.get();
  const std::string will = "offline";
  mosquitto_will_set(client, (base_ + "/status").c_str(), static_cast<int>(will.size()),
                     will.data(), kConfirmed, kRetained);
  set_security(settings);
  mosquitto_threaded_set(client, true);
  mosquitto_connect_callback_set(client, [](mosquitto* /*client*/, void* self, int code) {
    static_cast<MqttPublisher*>(self)->on_connect(code);
  });
  mosquitto_disconnect_callback_set(client, [](mosquitto* /*client*/, void* self, int /*code*/) {
    static_cast<MqttPublisher*>(self)->on_disconnect();
  });
  mosquitto_publish_callback_set(client, [](mosquitto* /*client*/, void* self, int number) {
    static_cast<MqttPublisher*>(self)->on_confirmed(number);
  });
}

void MqttPublisher::set_security(const MqttSettings& settings) {
  if (!settings.user.empty()) {
    const std::string password = settings.password_file.empty()
                                     ? std::string{}
                                     : first_line(settings.password_file, "password_file");
    mosquitto_username_pw_set(client_.get(), settings.user.c_str(), or_null(password));
  }
  if (settings.cert_file.empty() != settings.key_file.empty() ||
      (settings.ca_file.empty() && !settings.cert_file.empty()))
    throw UsageError{"[mqtt] cert_file and key_file: each needs the other, and ca_file"};
  if (settings.ca_file.empty()) return;
  const int code =
      mosquitto_tls_set(client_.get(), settings.ca_file.c_str(), nullptr,
                        or_null(settings.cert_file), or_null(settings.key_file), nullptr);
  if (code != MOSQ_ERR_SUCCESS)
    throw UsageError{fmt::format("[mqtt] ca_file, cert_file, key_file: {}: {}", settings.ca_file,
                                 mosquitto_strerror(code))};
}

MqttPublisher::~MqttPublisher() {
  thread_.request_stop();
  thread_.join();
  // Of a run that did not end the broker tells the last will.
  if (status_ != "online" && connected()) {
    mosquitto_disconnect(client_.get());
    constexpr int kMostTurns = 20;
    for (int i = 0; i < kMostTurns; ++i)
      if (mosquitto_loop(client_.get(), kTurnMs, 1) != MOSQ_ERR_SUCCESS) break;
  }
  client_.reset();
  mosquitto_lib_cleanup();
}

void MqttPublisher::publish(const std::string& live_json) {
  const std::lock_guard lock{mutex_};
  live_ = live_json;
  if (connected_) send(base_ + "/live", live_);
}

void MqttPublisher::tell(const AlarmChange& change, double time_s) {
  const WatchState& watch = change.watch;
  const nlohmann::ordered_json text{{"schema", "dampline.alarm/1"},
                                    {"vehicle", vehicle_},
                                    {"truck", truck_},
                                    {"name", watch.name},
                                    {"state", watch.active ? "raised" : "cleared"},
                                    {"value", number(watch.value)},
                                    {"limit", number(watch.limit)},
                                    {"unit", watch.unit},
                                    {"time_s", time_s}};
  const std::lock_guard lock{mutex_};
  alarms_.push_back({base_ + "/alarm/" + level(watch.name), text.dump(), 0});
  if (alarms_.size() > kMostWaiting) {
    alarms_.pop_front();
    ++dropped_;
  }
  if (connected_) send_waiting();
}

void MqttPublisher::end(const std::string& live_json) {
  constexpr std::chrono::seconds kLongest{5};
  std::unique_lock lock{mutex_};
  live_ = live_json;
  status_ = "ended";
  if (!connected_) return;
  send(base_ + "/live", live_);
  send(base_ + "/status", status_, &last_);  // what was sent before is there by then
  confirmed_.wait_for(lock, kLongest,
                      [&] { return (last_ == 0 && alarms_.empty()) || !connected_; });
}

bool MqttPublisher::connected() const {
  const std::lock_guard lock{mutex_};
  return connected_;
}

std::size_t MqttPublisher::waiting() const {
  const std::lock_guard lock{mutex_};
  return alarms_.size();
}

std::uint64_t MqttPublisher::dropped() const {
  const std::lock_guard lock{mutex_};
  return dropped_;
}

void MqttPublisher::on_connect(int code) {
  const std::lock_guard lock{mutex_};
  connected_ = code == 0;
  if (!connected_) return;
  send(base_ + "/status", status_);
  if (!live_.empty()) send(base_ + "/live", live_);
  send_waiting();
}

void MqttPublisher::on_disconnect() {
  const std::lock_guard lock{mutex_};
  connected_ = false;
  confirmed_.notify_all();
}

void MqttPublisher::on_confirmed(int number) {
  const std::lock_guard lock{mutex_};
  std::erase_if(alarms_, [&](const Alarm& alarm) { return alarm.number == number; });
  if (number == last_) last_ = 0;
  confirmed_.notify_all();
}

void MqttPublisher::send(const std::string& topic, const std::string& text, int* number) const {
  mosquitto_publish(client_.get(), number, topic.c_str(), static_cast<int>(text.size()),
                    text.data(), kConfirmed, kRetained);
}

/// What was sent once the library sends again by itself.
void MqttPublisher::send_waiting() {
  for (Alarm& alarm : alarms_)
    if (alarm.number == 0) send(alarm.topic, alarm.text, &alarm.number);
}

std::unique_ptr<MqttPublisher> open_mqtt(const Config& config) {
  if (config.mqtt.broker.empty()) return nullptr;
  return std::make_unique<MqttPublisher>(config);
}

}  // namespace dampline::app
