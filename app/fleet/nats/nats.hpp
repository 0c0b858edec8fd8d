// SPDX-License-Identifier: MIT
// States by NATS: subject dl.state.VEHICLE.TRUCK.START, kept by stream FLEET of the hub.
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/error.hpp"
#include "app/run/state.hpp"

namespace dampline::app::fleet {

/// Where a server is, and who comes.
struct NatsAddress {
  std::string url;  ///< "nats://127.0.0.1:4222", "tls://hub:4222"; several: by commas
  std::string ca_file, cert_file, key_file;  ///< of TLS; the certificate is who comes
  std::string creds_file;                    ///< of a server that knows clients by tokens and keys
};

/// Whether the program was built with libnats; without it sender and receiver refuse to be made.
[[nodiscard]] bool has_nats() noexcept;

/// "nats://..." or "tls://...".
[[nodiscard]] bool is_nats(const std::string& source);

/// The subject of a segment's states.
[[nodiscard]] std::string subject_of(const Segment& segment);

/// Sends states, each until the hub's stream has it. Between sender and hub may be leaf servers:
/// who confirms is the hub.
class NatsSender {
 public:
  /// Answers come to _INBOX.VEHICLE, so that a car's permissions need name that vehicle alone. A
  /// server that is not there is waited for. Throws UsageError for an address or a file that cannot
  /// be used.
  NatsSender(const NatsAddress& address, const std::string& vehicle);
  ~NatsSender();
  NatsSender(const NatsSender&) = delete;
  NatsSender& operator=(const NatsSender&) = delete;

  /// Empty: the hub has it. Else why it may not, for instance "no stream takes it"; to be sent
  /// again, which does no harm.
  [[nodiscard]] std::string send(const Segment& segment, std::string_view bytes,
                                 std::chrono::milliseconds patience);

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

/// A hub that is not there, or refuses.
struct NatsError : RunError {
  using RunError::RunError;
};

struct NatsMessage {
  std::string subject;
  std::string bytes;
};

/// Takes states from the hub's stream, as a consumer that the hub knows by name: what was confirmed
/// does not come again. Makes the stream where it is missing: one message for each subject.
class NatsReceiver {
 public:
  /// `again`: everything that the stream holds comes once more. Throws RunError where the hub
  /// cannot be reached or refuses, UsageError as NatsSender.
  NatsReceiver(const NatsAddress& address, const std::string& consumer, bool again);
  ~NatsReceiver();
  NatsReceiver(const NatsReceiver&) = delete;
  NatsReceiver& operator=(const NatsReceiver&) = delete;

  /// At most `most`, what there is or comes within `patience`; empty: nothing. Throws RunError
  /// where the connection is lost for longer.
  [[nodiscard]] std::vector<NatsMessage> fetch(int most, std::chrono::milliseconds patience);
  /// What fetch() gave last is kept safely.
  void confirm();

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

}  // namespace dampline::app::fleet
