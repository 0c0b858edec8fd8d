// SPDX-License-Identifier: MIT
#include "app/run/provenance.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>
#include <toml++/toml.h>

#include <array>
#include <fstream>
#include <vector>

#include "app/error.hpp"
#include "app/text/format.hpp"

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

std::string version() { return DAMPLINE_VERSION; }

std::string write_run_toml(const Config& config, const std::vector<InputFile>& inputs) {
  std::string out =
      show_config(config) + fmt::format("\n[run]\nversion = {}\n", toml_string(version()));
  for (const InputFile& input : inputs) {
    out += fmt::format("\n[[run.input]]\nname = {}\nrole = {}\n", toml_string(input.name),
                       toml_string(input.role));
    if (!input.sha256.empty())
      out += fmt::format("bytes = {}\nsha256 = {}\n", input.bytes, toml_string(input.sha256));
  }
  return out;
}

Provenance read_provenance(std::string_view text, const std::string& origin) {
  Provenance provenance;
  try {
    const toml::table file = toml::parse(text, origin);
    const auto run = file["run"];
    if (!run.is_table()) throw RunError{fmt::format("{}: no table [run]", origin)};
    provenance.version = run["version"].value_or(std::string{});
    if (const toml::array* list = run["input"].as_array()) {
      for (const toml::node& node : *list) {
        const toml::node_view<const toml::node> entry{node};
        provenance.inputs.push_back(
            {entry["name"].value_or(std::string{}), entry["role"].value_or(std::string{}),
             static_cast<std::uint64_t>(entry["bytes"].value_or(std::int64_t{0})),
             entry["sha256"].value_or(std::string{})});
      }
    }
  } catch (const toml::parse_error& error) {
    throw RunError{
        fmt::format("{}:{}: not TOML: {}", origin, error.source().begin.line, error.description())};
  }
  return provenance;
}

}  // namespace dampline::app
