// SPDX-License-Identifier: MIT
#include "app/diagnosis/common/json.hpp"

namespace dampline::app {

namespace {

using Json = nlohmann::ordered_json;

const char* symmetry_of(const Signature& s) {
  if (s.odd_share > Signature::kMostly) return "odd";
  return s.odd_share < 1.0 - Signature::kMostly ? "even" : "mixed";
}

}  // namespace

Json signature_json(const Signature& s, const std::array<const char*, kEvidenceChannels>& channels,
                    bool unknown) {
  Json coherence = Json::array();
  for (std::size_t c = 0; c < channels.size(); ++c)
    coherence.push_back({{"channel", channels[c]}, {"coherence", s.coherence[c]}});
  return {{"effect", unknown ? Json("unknown") : Json(nullptr)},
          {"rms_n", s.rms_n},
          {"memoryless", s.memoryless()},
          {"memory", s.has_memory()},
          {"symmetry", s.memoryless() ? Json(symmetry_of(s)) : Json(nullptr)},
          {"surface_share", s.surface_share},
          {"surface_odd_share", s.odd_share},
          {"travel_share", s.travel_share},
          {"frequency_hz", {{"low", s.low_hz}, {"peak", s.peak_hz}, {"high", s.high_hz}}},
          {"time_s", {{"worst", s.worst_time_s}, {"worst_over_median", s.worst_share}}},
          {"coherence", coherence},
          {"text", describe(s)}};
}

Json unknown_step(const std::vector<std::string>& terms, double held_out_nmse,
                  const Signature& signature) {
  return {{"effect", "unknown"},
          {"terms", terms},
          {"held_out_nmse_before", held_out_nmse},
          {"held_out_nmse_after", held_out_nmse},
          {"parameters", Json::array()},
          {"evidence", {{"signature", describe(signature)}}},
          {"runners_up", Json::array()}};
}

Json judged_json(const std::vector<JudgedCandidate>& candidates) {
  Json out = Json::array();
  for (const JudgedCandidate& c : candidates)
    out.push_back({{"effect", c.effect},
                   {"held_out_nmse", c.held_out_nmse},
                   {"gain", c.gain},
                   {"block_t", c.block_t}});
  return out;
}

}  // namespace dampline::app
