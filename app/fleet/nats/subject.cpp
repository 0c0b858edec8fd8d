// SPDX-License-Identifier: MIT
#include "app/fleet/nats/nats.hpp"
#include "app/fleet/spool.hpp"

namespace dampline::app::fleet {

bool is_nats(const std::string& source) {
  return source.starts_with("nats://") || source.starts_with("tls://");
}

std::string subject_of(const Segment& segment) { return "dl.state." + segment_name(segment); }

}  // namespace dampline::app::fleet
