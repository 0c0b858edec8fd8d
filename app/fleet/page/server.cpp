// SPDX-License-Identifier: MIT
#include "app/fleet/page/server.hpp"

#include <fmt/format.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string_view>

#include "app/error.hpp"
#include "app/fleet/database.hpp"
#include "app/fleet/page/page.hpp"
#include "app/fleet/page/view.hpp"
#include "app/report/assets.hpp"
#include "app/run/disk.hpp"
#include "app/serve/exposition.hpp"
#include "app/serve/http.hpp"
#include "app/text/format.hpp"

namespace dampline::app::fleet::page {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kPageType = "text/html; charset=utf-8";
constexpr const char* kTextType = "text/plain; charset=utf-8";
constexpr const char* kCsvType = "text/csv; charset=utf-8";

/// What the pages have beyond those of runs.
constexpr std::string_view kFleetStyle =
    "body { max-width: 76rem; }\n"
    "nav { margin: 0 0 1rem; }\n"
    "nav form { display: inline-block; margin-left: 1rem; }\n"
    "nav input, nav button { font: inherit; color: inherit; background: var(--tint); border: 1px "
    "solid var(--grey); padding: 0.1rem 0.4rem; max-width: 100%; }\n"
    "a { color: var(--blue); }\n"
    "@media (max-width: 40rem) { nav form { display: block; margin: 0.4rem 0 0; } }\n";

/// The answers, from a database that is opened when it is needed and again after it was away.
class Answers {
 public:
  explicit Answers(std::string database) : database_{std::move(database)} {
    static_cast<void>(connection());
  }

  [[nodiscard]] std::optional<HttpServer::Made> operator()(const HttpServer::Asked& asked) {
    try {
      return answer(asked);
    } catch (const RunError& error) {
      open_.reset();
      warn(error.what());
      return HttpServer::Made{kTextType, "the database does not answer\n", kUnavailable};
    }
  }

 private:
  static constexpr unsigned kUnavailable = 503;

  store::Connection& connection() {
    if (!open_) open_ = std::make_unique<Database>(database_, Database::Access::kRead);
    return open_->connection();
  }

  std::optional<HttpServer::Made> answer(const HttpServer::Asked& asked) {
    constexpr std::string_view kCsv = ".csv";
    if (asked.path == "/") return page(fleet_page(fleet(), connection().name(), Kind::kServed));
    if (asked.path == "/metrics")
      return HttpServer::Made{Exposition::kType, fleet_metrics(fleet())};
    if (asked.path == "/fleet.json")
      return HttpServer::Made{"application/json; charset=utf-8", fleet_json(fleet())};
    if (asked.path == "/healthz") {
      static_cast<void>(connection().has_table("state"));
      return HttpServer::Made{kTextType, "serving\n"};
    }
    if (asked.path == "/cars") return cars(asked.value("from"));
    if (asked.path == "/car") return car(asked.value("vehicle"));
    if (asked.path.ends_with(kCsv))
      return csv(asked.path.substr(1, asked.path.size() - 1 - kCsv.size()), asked.value("vehicle"));
    return std::nullopt;
  }

  static HttpServer::Made page(std::string html) { return {kPageType, std::move(html)}; }

  /// What is a few seconds old is still new: collectors write every few seconds at most.
  const Fleet& fleet() {
    constexpr std::chrono::seconds kFresh{5};
    if (!fleet_ || Clock::now() - read_at_ > kFresh) {
      fleet_ = read_fleet(connection());
      read_at_ = Clock::now();
    }
    return *fleet_;
  }

  HttpServer::Made cars(const std::string& from) {
    std::int64_t first = 0;
    std::from_chars(from.data(), from.data() + from.size(), first);
    first = std::max<std::int64_t>(first, 0);
    return page(cars_page(read_cars(connection(), first, kCarsOnPage, fleet().outliers), first));
  }

  HttpServer::Made car(const std::string& vehicle) {
    constexpr unsigned kNotFound = 404;
    const std::optional<Car> found = read_car(connection(), vehicle, fleet());
    if (!found)
      return {kPageType,
              framed("no such car", "<p>No segment is of a car of that name.</p>\n", Kind::kServed),
              kNotFound};
    return page(car_page(*found, connection().name(), Kind::kServed));
  }

  std::optional<HttpServer::Made> csv(std::string_view view, const std::string& vehicle) {
    if (!is_view(view)) return std::nullopt;
    // Of all cars these have a row for each segment or month: `dampline fleet --csv` has them.
    const bool is_long = view == "segment" || view == "month";
    if (is_long && vehicle.empty()) return std::nullopt;
    return HttpServer::Made{
        kCsvType,
        view_csv(connection(), view, vehicle.empty() ? std::nullopt : std::optional{vehicle}), 200,
        fmt::format("{}.csv", view)};
  }

  std::string database_;
  std::unique_ptr<Database> open_;
  std::optional<Fleet> fleet_;
  Clock::time_point read_at_;
};

/// SIGINT and SIGTERM as something that can be read.
class StopSignals {
 public:
  StopSignals() {
    sigset_t wanted;
    ::sigemptyset(&wanted);
    ::sigaddset(&wanted, SIGINT);
    ::sigaddset(&wanted, SIGTERM);
    ::pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
    descriptor_ = Descriptor{::signalfd(-1, &wanted, SFD_NONBLOCK | SFD_CLOEXEC)};
    if (descriptor_.get() < 0) throw RunError{"cannot serve: no file descriptor is left"};
  }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }
  [[nodiscard]] bool came() const noexcept {
    signalfd_siginfo seen{};
    return ::read(descriptor_.get(), &seen, sizeof seen) > 0;
  }

 private:
  Descriptor descriptor_;
};

}  // namespace

void serve_fleet(const FleetServerSettings& settings) {
  constexpr std::chrono::milliseconds kTurn{1000};
  const StopSignals signals;
  HttpServer server{http_settings({settings.address, "--serve"},
                                  {settings.token_file, "--serve-token-file"},
                                  "--serve-token-file")};
  const auto answers = std::make_shared<Answers>(settings.database);
  server.set("/fleet.css", "text/css; charset=utf-8",
             std::string{page_style()} + std::string{kFleetStyle});
  server.set("/uplot.js", "text/javascript; charset=utf-8", std::string{uplot_script()});
  server.set("/plots.js", "text/javascript; charset=utf-8", std::string{plots_script()});
  server.make_by([answers](const HttpServer::Asked& asked) { return (*answers)(asked); });
  fmt::print(stderr, "serving {}\n", server.where(settings.address));
  while (!signals.came()) server.turn(kTurn, signals.descriptor());
}

}  // namespace dampline::app::fleet::page
