// SPDX-License-Identifier: MIT
// From the kernel to the result: the frames of one instant through a local socket, recvmmsg as the
// CAN source calls it, decoding and the whole chain. The time begins before recvmmsg. `socket
// [--json FILE]`; some seconds. See bench/README.md.
#include <fmt/format.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "bench/chain.hpp"
#include "bench/ride.hpp"
#include "drivers/socketcan/message.hpp"

namespace dampline::bench {
namespace {

constexpr std::int64_t kWarmUp = 27'000;
constexpr std::int64_t kInstants = 300'000;
using Clock = std::chrono::steady_clock;

/// Two ends of a local datagram socket, whose messages are whole frames as on a CAN socket.
class Pair {
 public:
  Pair() { ok_ = ::socketpair(AF_UNIX, SOCK_DGRAM, 0, ends_.data()) == 0; }
  ~Pair() {
    if (!ok_) return;
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  [[nodiscard]] bool ok() const noexcept { return ok_; }

  [[nodiscard]] bool send(const CanFrame& frame) const noexcept {
    can_frame wire{};
    wire.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
    wire.can_dlc = frame.length;
    std::memcpy(static_cast<void*>(wire.data), frame.data.data(), frame.length);
    return ::send(ends_[0], &wire, sizeof wire, 0) == static_cast<ssize_t>(sizeof wire);
  }
  [[nodiscard]] std::size_t receive(drivers::MessageBatch& batch) const noexcept {
    const auto headers = batch.prepare(kChannels);
    const int got = ::recvmmsg(ends_[1], headers.data(), static_cast<unsigned>(headers.size()),
                               MSG_DONTWAIT, nullptr);
    return got > 0 ? static_cast<std::size_t>(got) : 0;
  }

 private:
  std::array<int, 2> ends_{};
  bool ok_{false};
};

/// Nanoseconds of each instant, sorted; empty where a frame was lost.
template <Parts kParts>
std::vector<std::int64_t> measure() {
  const Pair pair;
  const auto chain = std::make_unique<Chain<kParts>>();
  const auto batch = std::make_unique<drivers::MessageBatch>();
  FrameFeed feed;
  std::vector<std::int64_t> times;
  times.reserve(static_cast<std::size_t>(kInstants));
  std::array<CanFrame, kChannels> received;
  for (std::int64_t i = -kWarmUp; i < kInstants; ++i) {
    const auto frames = feed.next();
    for (const CanFrame& frame : frames)
      if (!pair.ok() || !pair.send(frame)) return {};
    const auto start = Clock::now();
    if (pair.receive(*batch) != kChannels) return {};
    for (std::size_t c = 0; c < kChannels; ++c) {
      if (!drivers::from_wire(batch->frame(c), batch->bytes(c), received[c])) return {};
      received[c].time_ns = frames[c].time_ns;  // no CAN controller stamps these
    }
    chain->push(received);
    if (i >= 0) times.push_back(std::chrono::nanoseconds{Clock::now() - start}.count());
  }
  std::sort(times.begin(), times.end());
  return chain->snapshot().valid ? times : std::vector<std::int64_t>{};
}

template <Parts kParts>
bool report(const char* name, nlohmann::json& out) {
  const std::vector<std::int64_t> times = measure<kParts>();
  if (times.empty()) return false;
  const auto at = [&times](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  fmt::print("| {} | {} | {} | {} | {} | {} |\n", name, at(0.5), at(0.9), at(0.99), at(0.999),
             times.back());
  out["socket_ns"].push_back({{"name", name},
                              {"p50", at(0.5)},
                              {"p90", at(0.9)},
                              {"p99", at(0.99)},
                              {"p99.9", at(0.999)},
                              {"max", times.back()}});
  return true;
}

int run(int argc, char** argv) {
  nlohmann::json out;
  fmt::print(
      "| recvmmsg to result, ns per instant of three frames, {} instants | p50 | p90 | p99 | p99.9 "
      "| largest |\n|--|--|--|--|--|--|\n",
      kInstants);
  const bool ok = report<kFramesToEstimate>("to the estimate", out) &&
                  report<kFramesToDensities>("and densities", out) &&
                  report<kIdentifyParts>("and phase and guards", out) &&
                  report<kExplainParts>("and every candidate's sums", out);
  if (!ok) fmt::print("a frame was lost on the way\n");
  if (argc == 3 && std::string_view{argv[1]} == "--json")
    std::ofstream{argv[2]} << out.dump(2) << '\n';
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
