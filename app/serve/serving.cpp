// SPDX-License-Identifier: MIT
#include "app/serve/serving.hpp"

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/error.hpp"
#include "app/live/status.hpp"
#include "app/record/rate.hpp"
#include "app/report/assets.hpp"
#include "app/serve/assets.hpp"
#include "app/serve/exposition.hpp"
#include "app/serve/metrics.hpp"

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kTurn{100};
constexpr std::chrono::milliseconds kTellEvery{500};
constexpr int kServeNice = 10;  // the acquisition and the writer come first

constexpr const char* kJsonType = "application/json; charset=utf-8";
constexpr const char* kTextType = "text/plain; charset=utf-8";

std::string event(std::string_view name, std::string_view data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, data);
}

/// While it lives, threads that are made do not take the program's signals.
class NoSignals {
 public:
  NoSignals() noexcept {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  NoSignals(const NoSignals&) = delete;
  NoSignals& operator=(const NoSignals&) = delete;
  ~NoSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

}  // namespace

std::unique_ptr<Serving> open_serving(const Config& config) {
  if (config.serve.address.empty()) return nullptr;
  auto out = std::make_unique<Serving>(config);
  fmt::print(stderr, "serving {}\n", out->where());
  return out;
}

Serving::Serving(const Config& config)
    : config_{config},
      server_{http_settings({config.serve.address, "[serve] address"},
                            {config.serve.token_file, "[serve] token_file"},
                            "[serve] token_file or client_ca_file", read_tls(config.serve))},
      view_{config} {
  where_ = server_.where(config.serve.address);
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (wake_ < 0) throw RunError{"cannot serve: no file descriptor is left"};
  set_assets();
  set_health({"waiting", 0, 0.0});
  state_.state = "waiting";
  const NoSignals none;
  thread_ = std::thread{[this] { run(); }};
}

Serving::~Serving() {
  stop_.store(true, std::memory_order_release);
  wake();
  if (thread_.joinable()) thread_.join();
  if (wake_ >= 0) ::close(wake_);
}

void Serving::wake() const noexcept { static_cast<void>(::eventfd_write(wake_, 1)); }

void Serving::publish(const RunResult& result, const std::string& text) {
  {
    const std::lock_guard lock{mutex_};
    news_ = News{result, text};
  }
  wake();
}

void Serving::turn(const ServedState& state) {
  const std::lock_guard lock{mutex_};
  state_ = state;
}

void Serving::set_assets() {
  server_.set("/", "text/html; charset=utf-8", std::string{live_page()});
  server_.set("/live.css", "text/css; charset=utf-8",
              std::string{page_style()} + std::string{live_style()});
  server_.set("/uplot.js", "text/javascript; charset=utf-8", std::string{uplot_script()});
  server_.set("/live.js", "text/javascript; charset=utf-8", std::string{live_script()});
  server_.stream_at("/events");
  const ServerFigures figures;
  server_.set("/metrics", Exposition::kType, metrics_text(newest_, &figures));
  server_.set("/live.json", kJsonType, "{}\n");
  server_.set("/view.json", kJsonType, view_.document(sequence_));
}

void Serving::set_health(const ServedState& state) {
  server_.set("/healthz", kTextType, fmt::format("{}\n", state.state),
              state.state == "fault" ? 503 : 200);
}

void Serving::run() {
  using Clock = std::chrono::steady_clock;
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, kServeNice));  // of this thread
  auto next = Clock::now();
  while (!stop_.load(std::memory_order_acquire)) {
    take_motion();
    take_news();
    if (Clock::now() >= next) {
      tell();
      next = Clock::now() + kTellEvery;
    }
    server_.turn(kTurn, wake_);
    eventfd_t calls = 0;
    static_cast<void>(::eventfd_read(wake_, &calls));
  }
}

void Serving::take_motion() {
  for (Motion motion; tap_.pop(motion);) view_.take(motion, tap_.first_tick());
}

void Serving::take_news() {
  std::optional<News> news;
  {
    const std::lock_guard lock{mutex_};
    news.swap(news_);
  }
  if (!news) return;
  newest_ = std::move(news->result);
  view_.take(newest_);
  ++sequence_;
  server_.set("/live.json", kJsonType, std::move(news->text));
  server_.set("/view.json", kJsonType, view_.document(sequence_));
  tell();
}

/// What goes to the readers of the stream, and what changes between two results.
void Serving::tell() {
  ServedState state;
  {
    const std::lock_guard lock{mutex_};
    state = state_;
  }
  set_health(state);
  const ServerFigures figures{server_.requests(), server_.readers(), tap_.lost()};
  server_.set("/metrics", Exposition::kType, metrics_text(newest_, &figures));
  server_.send(event("now", now_text(state, view_.newest_motion())),
               "retry: 2000\n" + event("now", now_text(state, view_.shown_motion())));
}

std::string Serving::now_text(const ServedState& state, const std::string& motion) const {
  const double elapsed_s = static_cast<double>(state.samples) / truck_rate_hz(config_.input);
  std::string collecting = "null";
  if (newest_.parameters.empty()) {
    const Collecting c = collecting_of(elapsed_s, tap_.blocks(), config_);
    collecting = fmt::format(R"({{"have_s":{:.1f},"need_s":{:.1f}}})", c.have_s, c.need_s);
  }
  nlohmann::json raised = nlohmann::json::array();
  for (const WatchState& watch : newest_.watched)
    if (watch.active) raised.push_back(watch.name);
  return fmt::format(
      R"({{"sequence":{},"state":"{}","record_s":{:.1f},"shown_s":{:.2f},"silence_s":{:.1f},)"
      R"("collecting":{},"raised":{},"motion":{}}})",
      sequence_, state.state, elapsed_s, view_.motion_time_s(), state.silence_s, collecting,
      raised.dump(), motion);
}

}  // namespace dampline::app
