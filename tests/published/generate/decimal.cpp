// SPDX-License-Identifier: MIT
#include "tests/published/generate/decimal.hpp"

#include <cstddef>
#include <sstream>

namespace dampline::generate {

std::string decimal(const mpf_class& x) {
  constexpr std::size_t kDigits = 25;
  mp_exp_t exponent = 0;
  std::string digits = x.get_str(exponent, 10, kDigits);
  if (digits.empty()) return "0.0";
  const std::size_t first = digits[0] == '-' ? 1 : 0;
  digits.resize(first + kDigits, '0');
  std::ostringstream out;
  out << digits.substr(0, first + 1) << '.' << digits.substr(first + 1) << 'e' << exponent - 1;
  return out.str();
}

}  // namespace dampline::generate
