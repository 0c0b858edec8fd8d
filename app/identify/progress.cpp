// SPDX-License-Identifier: MIT
#include "app/identify/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kInterval{200};

}  // namespace

Progress::Progress(bool enabled)
    : enabled_{enabled}, start_{std::chrono::steady_clock::now()}, next_{start_ + kInterval} {}

bool Progress::due() {
  if (!enabled_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + kInterval;
  return true;
}

void Progress::show(std::optional<double> share, double time_s, const std::string& state) {
  if (!enabled_) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const std::string percent =
      share ? fmt::format("{:3.0f} %  ", std::min(99.0, 100.0 * *share)) : std::string{};
  const std::string speed = time_s > 0.0
                                ? fmt::format("{:.0f} s of record, {:.0f} x real time  ", time_s,
                                              time_s / std::max(elapsed.count(), 1e-9))
                                : std::string{};
  fmt::print(stderr, "\r\033[K{}{}{}", percent, speed, state);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

std::optional<double> estimate_lines(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
  std::array<char, 65536> head{};
  std::ifstream stream{path, std::ios::binary};
  stream.read(head.data(), head.size());
  const auto count = static_cast<double>(stream.gcount());
  const auto lines = static_cast<double>(std::count(head.begin(), head.end(), '\n'));
  if (error || lines < 1.0) return std::nullopt;
  return bytes * lines / count;
}

}  // namespace dampline::app
