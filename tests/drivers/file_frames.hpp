// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "drivers/record/frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::test {

/// All that a file of frames gives, to its end or to what ends it.
struct FileFrames {
  std::vector<CanFrame> frames;
  hal::SourceHealth health;
  std::string error;
  Errc reason{};
  std::vector<std::string> interfaces;
};

inline FileFrames frames_of(drivers::Outcome<std::unique_ptr<drivers::RecordedFrames>> source) {
  if (!source) return {{}, {}, source.error_text(), source.failure().code, {}};
  FileFrames out;
  std::array<CanFrame, 3> part;
  auto read = source.value()->read(part);
  for (; read; read = source.value()->read(part))
    out.frames.insert(out.frames.end(), part.begin(),
                      part.begin() + static_cast<std::ptrdiff_t>(read.value()));
  out.reason = read.error();
  out.health = source.value()->health();
  out.error = source.value()->error_text();
  for (std::size_t i = 0; i < source.value()->interfaces().size(); ++i)
    out.interfaces.emplace_back(source.value()->interfaces().name(i));
  return out;
}

/// Of a file with these bytes, whose format they tell.
inline FileFrames frames_of(const std::string& bytes, bool skip = false) {
  const TemporaryFile file{bytes};
  return frames_of(drivers::open_frames({.path = file.path(), .skip_bad_lines = skip}));
}

}  // namespace dampline::test
