// SPDX-License-Identifier: MIT
#include "app/text/meaning.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace dampline::app {
namespace {

using Entry = std::pair<std::string_view, std::string_view>;

constexpr std::array<Entry, 13> kParameters{{
    {"coulomb", "dry friction: force level, whatever the speed"},
    {"coulomb_positive", "dry friction while v > 0"},
    {"coulomb_negative", "dry friction while v < 0"},
    {"stiffness", "spring of the suspension"},
    {"viscous", "damping that grows with speed"},
    {"viscous_positive", "damping that grows with speed, v > 0"},
    {"viscous_negative", "damping that grows with speed, v < 0"},
    {"coulomb_with_viscous", "dry friction in the model that has a viscous part"},
    {"viscous_at_rms", "force of the viscous part at the rms velocity"},
    {"law_width", "width of the jump at v = 0: rounding and velocity error"},
    {"moving_mass", "mass that moves"},
    {"offset", "constant force"},
    {"noise", "sensor noise of one channel, rms"},
}};

constexpr std::array<Entry, 20> kCounts{{
    {"samples", "samples read"},
    {"gaps", "gaps in the sequence"},
    {"lost", "samples lost in the gaps"},
    {"saturated", "samples with a channel at full scale"},
    {"stuck", "samples with a channel that stood still while another moved"},
    {"not_finite", "samples that are no number"},
    {"repeated", "samples that came twice or too late; ignored"},
    {"blocks", "blocks of about 2 s"},
    {"blocks_excluded", "blocks left out because of a fault"},
    {"blocks_still", "blocks at standstill"},
    {"blocks_used", "stretches of equal length that hold equations"},
    {"rows", "equations used"},
    {"rows_still", "equations left out: too little motion"},
    {"frames", "CAN frames read"},
    {"frames_dropped", "CAN frames known to be lost"},
    {"frames_foreign", "CAN frames of others"},
    {"incomplete", "instants that lacked a channel"},
    {"restarts", "long pauses after which the channels were aligned anew"},
    {"lines_malformed", "malformed lines, skipped on request"},
    {"frames_reordered", "frames with a time before that of the frame ahead of them"},
}};

std::string look_up(std::span<const Entry> entries, std::string_view name,
                    std::string_view otherwise) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return entry.first == name; });
  return std::string{found == entries.end() ? otherwise : found->second};
}

}  // namespace

std::string meaning_of_parameter(std::string_view name) { return look_up(kParameters, name, ""); }
std::string meaning_of_count(std::string_view name) { return look_up(kCounts, name, name); }

}  // namespace dampline::app
