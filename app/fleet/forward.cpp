// SPDX-License-Identifier: MIT
#include "app/fleet/forward.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/spool.hpp"

namespace dampline::app::fleet {

Forwarder::Forwarder(std::vector<std::string> sources, NatsAddress address, bool again)
    : sources_{std::move(sources)}, address_{std::move(address)}, again_{again} {}

bool Forwarder::is_due(const std::filesystem::path& file) const {
  std::error_code gone;  // by a spool that makes room
  if (refused_.contains(file) || !std::filesystem::exists(file, gone)) return false;
  return (again_ && !sent_again_.contains(file)) || !was_sent(file);
}

Forwarder::Round Forwarder::round(std::chrono::milliseconds patience) {
  Round out;
  for (const std::filesystem::path& file : state_files(sources_)) {
    if (!is_due(file)) continue;
    if (out.error.empty()) send(file, patience, out);
    if (!out.error.empty()) ++out.left;
  }
  return out;
}

void Forwarder::send(const std::filesystem::path& file, std::chrono::milliseconds patience,
                     Round& out) {
  std::string bytes;
  Leaf leaf;
  try {
    bytes = file_reader(file)();
    leaf = leaf_of(
        file, [&bytes] { return bytes; }, *scratch_);
    if (leaf.about.segments > 1) throw RunError{file.string() + ": is itself a merge"};
    if (leaf.about.segment.vehicle.empty() || leaf.about.segment.truck.empty())
      throw RunError{file.string() + ": names no vehicle or no truck: [record] names them"};
  } catch (const RunError& error) {
    refused_.insert(file);
    out.refused.push_back({file, error.what()});
    return;
  }
  const Segment& segment = leaf.about.segment;
  if (!sender_) sender_ = std::make_unique<NatsSender>(address_, segment.vehicle);
  out.error = sender_->send(segment, bytes, patience);
  if (!out.error.empty()) return;
  ++out.sent;
  if (again_) sent_again_.insert(file);
  try {
    mark_sent(file, bytes);
  } catch (const IoError& error) {
    out.error = error.what();
  }
}

}  // namespace dampline::app::fleet
