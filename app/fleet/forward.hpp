// SPDX-License-Identifier: MIT
// From a spool to the hub.
#pragma once
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/fleet/leaves.hpp"
#include "app/fleet/nats/nats.hpp"

namespace dampline::app::fleet {

/// Sends the states at some places to the hub, and marks beside each what the hub has confirmed.
/// Everything it knows lies in the folder: it may be killed and begin again at any time, and what
/// is sent twice counts once.
class Forwarder {
 public:
  /// `again`: what is marked as sent is sent once more.
  Forwarder(std::vector<std::string> sources, NatsAddress address, bool again);

  struct Round {
    std::uint64_t sent{0};
    std::uint64_t left{0};         ///< still to be sent
    std::string error;             ///< why; empty: nothing is left
    std::vector<LeftOut> refused;  ///< no states of a named car; each is told once
  };
  /// All that is to be sent, in the order of its names, until the first that the hub does not take
  /// within `patience`. Throws RunError for a folder that cannot be read.
  [[nodiscard]] Round round(std::chrono::milliseconds patience);

 private:
  [[nodiscard]] bool is_due(const std::filesystem::path& file) const;
  void send(const std::filesystem::path& file, std::chrono::milliseconds patience, Round& out);

  std::vector<std::string> sources_;
  NatsAddress address_;
  bool again_;
  std::set<std::filesystem::path> sent_again_;
  std::set<std::filesystem::path> refused_;
  std::unique_ptr<NatsSender> sender_;
  std::unique_ptr<Statistics> scratch_{std::make_unique<Statistics>()};
};

}  // namespace dampline::app::fleet
