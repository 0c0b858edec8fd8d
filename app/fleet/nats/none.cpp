// SPDX-License-Identifier: MIT
// In place of client.cpp where libnats is missing.
#include "app/fleet/nats/nats.hpp"

namespace dampline::app::fleet {
namespace {

[[noreturn]] void refuse(const NatsAddress& address) {
  throw UsageError{address.url +
                   ": NATS needs libnats, without which this program was built (Debian: "
                   "libnats-dev); expected a build with it"};
}

}  // namespace

bool has_nats() noexcept { return false; }

class NatsSender::Link {};
class NatsReceiver::Link {};

NatsSender::NatsSender(const NatsAddress& address, const std::string& /*vehicle*/) {
  refuse(address);
}
NatsSender::~NatsSender() = default;
std::string NatsSender::send(const Segment& /*segment*/, std::string_view /*bytes*/,
                             std::chrono::milliseconds /*patience*/) {
  return "there is no NATS";
}

NatsReceiver::NatsReceiver(const NatsAddress& address, const std::string& /*consumer*/,
                           bool /*again*/) {
  refuse(address);
}
NatsReceiver::~NatsReceiver() = default;
std::vector<NatsMessage> NatsReceiver::fetch(int /*most*/, std::chrono::milliseconds /*patience*/) {
  return {};
}
void NatsReceiver::confirm() {}

}  // namespace dampline::app::fleet
