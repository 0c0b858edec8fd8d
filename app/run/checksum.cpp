// SPDX-License-Identifier: MIT
#include "app/run/checksum.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>

#include <array>
#include <fstream>
#include <vector>

#include "app/error.hpp"

namespace dampline::app {

InputFile describe_input(const std::filesystem::path& file, const std::string& role) {
  InputFile input{file.string(), role, 0, ""};
  std::ifstream stream{file, std::ios::binary};
  if (!stream) throw RunError{fmt::format("{}: cannot be read", input.name)};
  sha256_ctx context{};
  sha256_init(&context);
  std::vector<char> buffer(std::size_t{1} << 18U);
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    const auto count = static_cast<std::size_t>(stream.gcount());
    sha256_update(&context, count, reinterpret_cast<const std::uint8_t*>(buffer.data()));
    input.bytes += count;
  }
  if (stream.bad()) throw RunError{fmt::format("{}: error while reading", input.name)};
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  for (const std::uint8_t byte : digest) input.sha256 += fmt::format("{:02x}", byte);
  return input;
}

}  // namespace dampline::app
