// SPDX-License-Identifier: MIT
#include "app/serve/tls.hpp"

#include <fmt/format.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <microhttpd.h>

#include <array>
#include <memory>
#include <string_view>
#include <type_traits>

#include "app/error.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

std::string read_pem(const std::string& file, std::string_view key) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  if (file.empty()) return "";
  auto text = drivers::read_whole(file, kMostBytes);
  if (!text.ok()) throw UsageError{fmt::format("[serve] {}: {}", key, text.error_text())};
  return std::move(text.value());
}

gnutls_datum_t datum_of(std::string& text) {
  return {reinterpret_cast<unsigned char*>(text.data()), static_cast<unsigned>(text.size())};
}

/// As the server will use them, so that what is wrong is told before it starts.
void check(TlsSettings tls, const ServeSettings& serve) {
  gnutls_certificate_credentials_t made = nullptr;
  if (gnutls_certificate_allocate_credentials(&made) != GNUTLS_E_SUCCESS) throw std::bad_alloc{};
  const std::unique_ptr<std::remove_pointer_t<gnutls_certificate_credentials_t>,
                        void (*)(gnutls_certificate_credentials_t)>
      owner{made, gnutls_certificate_free_credentials};
  const gnutls_datum_t certificate = datum_of(tls.certificate);
  const gnutls_datum_t key = datum_of(tls.key);
  if (const int error =
          gnutls_certificate_set_x509_key_mem(made, &certificate, &key, GNUTLS_X509_FMT_PEM);
      error < 0)
    throw UsageError{fmt::format("[serve] cert_file, key_file: {} and {}: {}", serve.cert_file,
                                 serve.key_file, gnutls_strerror(error))};
  if (tls.client_authorities.empty()) return;
  const gnutls_datum_t authorities = datum_of(tls.client_authorities);
  if (gnutls_certificate_set_x509_trust_mem(made, &authorities, GNUTLS_X509_FMT_PEM) <= 0)
    throw UsageError{fmt::format("[serve] client_ca_file: {}: holds no certificate, expected PEM",
                                 serve.client_ca_file)};
}

}  // namespace

TlsSettings read_tls(const ServeSettings& serve) {
  if (serve.cert_file.empty() != serve.key_file.empty())
    throw UsageError{"[serve] cert_file and key_file: found one of them, expected both"};
  if (serve.cert_file.empty()) {
    if (!serve.client_ca_file.empty())
      throw UsageError{"[serve] client_ca_file: expected cert_file and key_file beside it"};
    return {};
  }
  TlsSettings out{read_pem(serve.cert_file, "cert_file"), read_pem(serve.key_file, "key_file"),
                  read_pem(serve.client_ca_file, "client_ca_file")};
  check(out, serve);
  return out;
}

bool shows_certificate(MHD_Connection* connection) {
  const MHD_ConnectionInfo* info =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_GNUTLS_SESSION);
  if (info == nullptr || info->tls_session == nullptr) return false;
  std::string purpose{GNUTLS_KP_TLS_WWW_CLIENT};
  std::array<gnutls_typed_vdata_st, 1> expected{
      {{GNUTLS_DT_KEY_PURPOSE_OID, reinterpret_cast<unsigned char*>(purpose.data()), 0}}};
  unsigned wrong = 0;
  return gnutls_certificate_verify_peers(static_cast<gnutls_session_t>(info->tls_session),
                                         expected.data(), expected.size(),
                                         &wrong) == GNUTLS_E_SUCCESS &&
         wrong == 0;
}

}  // namespace dampline::app
