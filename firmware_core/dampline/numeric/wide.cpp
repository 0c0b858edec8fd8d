// SPDX-License-Identifier: MIT
#include "dampline/numeric/wide.hpp"

namespace dampline {

DAMPLINE_WIDE double wide_dot(const double* a, const double* b, std::size_t count) noexcept {
  Wide even{};
  Wide odd{};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    even += wide(a + i).numbers * wide(b + i).numbers;
    odd += wide(a + i + 4).numbers * wide(b + i + 4).numbers;
  }
  if (i + 4 <= count) {
    even += wide(a + i).numbers * wide(b + i).numbers;
    i += 4;
  }
  const Wide sum = even + odd;
  double out = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  for (; i < count; ++i) out += a[i] * b[i];
  return out;
}

}  // namespace dampline
