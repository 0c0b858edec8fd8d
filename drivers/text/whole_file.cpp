// SPDX-License-Identifier: MIT
#include "drivers/text/whole_file.hpp"

#include <fmt/format.h>

#include <fstream>

namespace dampline::drivers {

Outcome<std::string> read_whole(const std::string& path, std::size_t most) {
  std::ifstream in{path, std::ios::binary};
  if (!in) return Failure{Errc::kIo, fmt::format("{}: cannot be opened", path)};
  std::string text(most + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad() || (!in && !in.eof()))
    return Failure{Errc::kIo, fmt::format("{}: cannot be read", path)};
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > most)
    return Failure{Errc::kMalformed,
                   fmt::format("{}: is larger than {} bytes, expected at most that", path, most)};
  return text;
}

}  // namespace dampline::drivers
