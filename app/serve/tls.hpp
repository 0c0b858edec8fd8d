// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"

struct MHD_Connection;

namespace dampline::app {

/// What a server shows of itself over TLS and asks of its readers, as PEM text.
struct TlsSettings {
  std::string certificate;  ///< and those that lead to its authority; empty: no TLS
  std::string key;
  std::string client_authorities;  ///< who vouches for readers; empty: nobody has to
  [[nodiscard]] bool on() const noexcept { return !certificate.empty(); }
};

/// Of [serve] cert_file, key_file and client_ca_file. Throws UsageError naming the key, the file
/// and what is wrong with it.
[[nodiscard]] TlsSettings read_tls(const ServeSettings& serve);

/// Whether the reader of a connection over TLS showed a certificate of the authorities, good now
/// and meant for clients.
[[nodiscard]] bool shows_certificate(MHD_Connection* connection);

}  // namespace dampline::app
