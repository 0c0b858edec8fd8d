// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "app/config/config.hpp"
#include "app/run/result.hpp"
#include "app/serve/http.hpp"
#include "app/serve/tap.hpp"
#include "app/serve/view.hpp"

namespace dampline::app {

/// How a run stands, some times a second.
struct ServedState {
  std::string_view state;  ///< a literal
  std::uint64_t samples{0};
  double silence_s{0.0};
};

/// A run as it is seen from outside: page, live.json, metrics, events, health. One thread of its
/// own, of low priority; whoever calls publish() or turn() copies and goes on.
class Serving {
 public:
  /// Listens from now on. Throws UsageError for a wrong [serve], RunError when the address cannot
  /// be had. Precondition: config.serve.address is not empty.
  explicit Serving(const Config& config);
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  ~Serving();

  /// "http://127.0.0.1:9464/"
  [[nodiscard]] const std::string& where() const noexcept { return where_; }
  /// For the acquisition; lives as long as this.
  [[nodiscard]] MotionTap& tap() noexcept { return tap_; }
  /// A new version: `text` is live.json.
  void publish(const RunResult& result, const std::string& text);
  void turn(const ServedState& state);

 private:
  struct News {
    RunResult result;
    std::string text;
  };
  void run();
  void set_assets();
  void take_motion();
  void take_news();
  void tell();
  void set_health(const ServedState& state);
  [[nodiscard]] std::string now_text(const ServedState& state, const std::string& motion) const;
  void wake() const noexcept;

  Config config_;
  HttpServer server_;
  LiveView view_;
  MotionTap tap_;
  std::string where_;
  int wake_{-1};
  std::mutex mutex_;
  std::optional<News> news_;  // what the thread has not seen yet
  ServedState state_;         // under the mutex, too
  std::atomic<bool> stop_{false};
  // The thread's.
  RunResult newest_;
  std::uint64_t sequence_{0};
  std::thread thread_;
};

/// As [serve] says, told on the standard error; null: nothing is served.
[[nodiscard]] std::unique_ptr<Serving> open_serving(const Config& config);

}  // namespace dampline::app
