// SPDX-License-Identifier: MIT
// Writes to a black box as fast as it can, to be killed. Arguments: the directory, the number of
// the first frame, and how many frames at least, where nobody kills it. Standard output gets, as 8
// bytes each, how many frames are known to be on the disk.
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "tests/blackbox.hpp"

namespace {

constexpr std::uint64_t kMost = 4'000'000;

bool tell(std::uint64_t synced) {
  std::array<char, 8> bytes{};
  std::memcpy(bytes.data(), &synced, bytes.size());
  return ::write(STDOUT_FILENO, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  using dampline::test::numbered_frame;
  if (argc < 3) return 2;
  const std::uint64_t most = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : kMost;
  auto config = dampline::test::box_config(argv[1]);
  config.rotate_bytes = 300'000;
  auto opened = dampline::drivers::BlackboxWriter::open(config);
  if (!opened.ok()) return 1;
  auto& writer = *opened.value();
  const std::uint64_t first = std::strtoull(argv[2], nullptr, 10);
  std::int64_t now_ns = 0;
  std::uint64_t written = 0;
  for (std::uint64_t burst = 1; written < most; burst = burst * 7 % 1009) {
    for (std::uint64_t i = 0; i < burst; ++i) writer.write(numbered_frame(first + written++));
    now_ns += config.sync_interval_ns;
    writer.tick(now_ns);
    if (writer.health().lost > 0 || !tell(written)) return 1;
  }
  return 0;
}
