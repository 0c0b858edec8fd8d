// SPDX-License-Identifier: MIT
#include "sim_hw/simulated_source.hpp"

namespace dampline::sim {

SimulatedSource::SimulatedSource(const SimulationConfig& simulation, std::int64_t samples,
                                 const NodeConfig& nodes, const TransportConfig& transport)
    : simulation_(simulation),
      nodes_(nodes, simulation.seed),
      transport_(transport, simulation.seed),
      remaining_(samples) {}

Result<std::size_t> SimulatedSource::do_read(std::span<CanFrame> out) noexcept {
  std::size_t count = 0;
  while (count < out.size()) {
    if (!pending_.empty()) {
      out[count++] = pending_.front();
      pending_ = pending_.subspan(1);
      ++health_.frames;
    } else if (remaining_ > 0) {
      --remaining_;
      last_ = simulation_.next();
      pending_ = transport_.pass(nodes_.pack(last_), last_.time_s);
    } else {
      break;
    }
  }
  if (count == 0 && !out.empty()) return Errc::kEndOfStream;
  return count;
}

}  // namespace dampline::sim
