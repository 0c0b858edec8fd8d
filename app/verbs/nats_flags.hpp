// SPDX-License-Identifier: MIT
#pragma once
#include <CLI/CLI.hpp>

#include "app/fleet/nats/nats.hpp"

namespace dampline::app {

/// How a server is reached that wants to know who comes: the same for who sends and who collects.
inline void add_nats_flags(CLI::App& verb, fleet::NatsAddress& address) {
  verb.add_option("--ca", address.ca_file,
                  "certificates that the NATS server's is held against; TLS is used then");
  verb.add_option("--cert", address.cert_file, "certificate by which the server knows who comes");
  verb.add_option("--key", address.key_file, "and its key");
  verb.add_option("--creds", address.creds_file,
                  "a file of token and key, for a server that knows clients by these");
}

}  // namespace dampline::app
