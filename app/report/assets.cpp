// SPDX-License-Identifier: MIT
#include "app/report/assets.hpp"

#include <fmt/format.h>
#include <nettle/base64.h>
#include <nettle/sha2.h>

#include <array>

namespace dampline::app {
namespace {

/// As a policy names a script: 'sha256-...'.
std::string source_of(std::string_view script) {
  sha256_ctx context{};
  sha256_init(&context);
  sha256_update(&context, script.size(), reinterpret_cast<const std::uint8_t*>(script.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  std::string text(BASE64_ENCODE_RAW_LENGTH(SHA256_DIGEST_SIZE), '\0');
  base64_encode_raw(text.data(), digest.size(), digest.data());
  return "'sha256-" + text + "'";
}

}  // namespace

std::string page_head() {
  return fmt::format(
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; script-src {} {}; base-uri 'none'; form-action 'none'\">\n"
      "<style>{}</style>",
      source_of(uplot_script()), source_of(plots_script()), page_style());
}

std::string page_scripts() {
  return fmt::format("<script>{}</script>\n<script>{}</script>\n", uplot_script(), plots_script());
}

}  // namespace dampline::app
