// SPDX-License-Identifier: MIT
#include "app/fleet/store/store.hpp"

#include <fmt/format.h>

#include "app/error.hpp"

namespace dampline::app::fleet::store {

void Connection::fail_with(std::string_view words) {
  const std::string text = fmt::format("{}: {}", name(), words);
  if (failure_.empty()) failure_ = text;
  throw RunError{text};
}

bool is_postgresql(std::string_view where) {
  return where.starts_with("postgresql://") || where.starts_with("postgres://");
}

std::string without_password(const std::string& uri) {
  std::string out = uri;
  const std::size_t user = out.find("://") + 3;
  const std::size_t end = out.find_first_of("/?", user);
  const std::size_t at = out.rfind('@', end);
  const std::size_t colon = out.find(':', user);
  if (at != std::string::npos && at >= user && colon < at)
    out.replace(colon + 1, at - colon - 1, "***");
  constexpr std::string_view kParameter = "password=";
  for (std::size_t found = out.find(kParameter); found != std::string::npos;
       found = out.find(kParameter, found)) {
    found += kParameter.size();
    out.replace(found, out.find('&', found) - found, "***");
  }
  return out;
}

}  // namespace dampline::app::fleet::store
