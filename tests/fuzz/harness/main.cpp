// SPDX-License-Identifier: MIT
// libFuzzer's entry: DAMPLINE_FUZZED names the reader.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using dampline::fuzz::Reader;
  static const auto kReader =
      std::ranges::find(dampline::fuzz::readers(), DAMPLINE_FUZZED, &Reader::name);
  kReader->read({data, size});
  return 0;
}
