// SPDX-License-Identifier: MIT
// A live run told to an MQTT broker.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "app/alarm/alarms.hpp"
#include "app/config/config.hpp"

struct mosquitto;

namespace dampline::app {

/// Under TOPIC/VEHICLE/TRUCK, every message retained:
///
///   live          live.json, the newest
///   alarm/NAME    the newest change of each alarm, as JSON; at least once
///   status        "online", "ended" (the run is over), "offline" (the last will)
///
/// An outage of the broker is waited out: alarms wait for it, of live.json the newest. Its own
/// thread; nobody waits for a broker but end().
class MqttPublisher {
 public:
  static constexpr std::size_t kMostWaiting = 1000;  ///< alarms; beyond, the oldest goes

  /// Throws UsageError naming the key of [mqtt] that is wrong. Precondition: broker is not empty.
  explicit MqttPublisher(const Config& config);
  MqttPublisher(const MqttPublisher&) = delete;
  MqttPublisher& operator=(const MqttPublisher&) = delete;
  ~MqttPublisher();

  void publish(const std::string& live_json);
  void tell(const AlarmChange& change, double time_s);
  /// The run is over: its last live.json, and some seconds for what still waits.
  void end(const std::string& live_json);

  [[nodiscard]] bool connected() const;
  [[nodiscard]] std::size_t waiting() const;    ///< alarms that no broker has confirmed
  [[nodiscard]] std::uint64_t dropped() const;  ///< alarms that went
  [[nodiscard]] const std::string& base() const noexcept { return base_; }

 private:
  struct Alarm {
    std::string topic;
    std::string text;
    int number{0};  ///< of its message; 0: not sent yet
  };
  void work(const std::stop_token& stop, const std::string& host, int port);
  void prepare(const MqttSettings& settings);
  void set_security(const MqttSettings& settings);
  void on_connect(int code);
  void on_disconnect();
  void on_confirmed(int number);
  // With the mutex held:
  void send(const std::string& topic, const std::string& text, int* number = nullptr) const;
  void send_waiting();

  std::string base_;
  std::string vehicle_;
  std::string truck_;
  std::unique_ptr<mosquitto, void (*)(mosquitto*)> client_;
  mutable std::mutex mutex_;
  std::condition_variable_any confirmed_;
  bool connected_{false};
  std::string live_;
  std::string status_{"online"};
  std::deque<Alarm> alarms_;
  int last_{0};  ///< number of the message that ends the run; 0: none, or confirmed
  std::uint64_t dropped_{0};
  std::jthread thread_;
};

/// As [mqtt] says; null: nobody is told.
[[nodiscard]] std::unique_ptr<MqttPublisher> open_mqtt(const Config& config);

}  // namespace dampline::app
