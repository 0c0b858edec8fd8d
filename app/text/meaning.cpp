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

constexpr std::array<Entry, 37> kCounts{{
    {"samples", "samples read"},
    {"gaps", "gaps in the sequence"},
    {"lost", "samples lost in the gaps"},
    {"saturated", "samples with a channel at full scale"},
    {"stuck", "samples with a channel that stood still while another moved"},
    {"not_finite", "samples that are no number"},
    {"repeated", "samples that came twice or too late; ignored"},
    {"blocks", "blocks of about 2 s"},
    {"blocks_excluded", "blocks left out because of a fault"},
    {"blocks_spoilt", "of these because of a fault that the guards found"},
    {"blocks_still", "blocks at standstill"},
    {"blocks_used", "stretches of equal length that hold equations"},
    {"rows", "equations used"},
    {"rows_still", "equations left out: too little motion"},
    {"frames", "CAN frames read"},
    {"frames_sent", "CAN frames that were sent, as their counters tell"},
    {"frames_processed", "of these: became part of a sample"},
    {"frames_dropped", "of these: dropped by the kernel, for want of room"},
    {"frames_missing", "of these: never arrived"},
    {"frames_excluded", "of these: arrived and were not used, for the reasons below"},
    {"frames_error", "error frames of the bus"},
    {"frames_foreign", "of other senders"},
    {"frames_repeated", "came twice"},
    {"frames_late", "came too late"},
    {"frames_out_of_step", "their counter contradicts their time"},
    {"frames_wrong_length", "too short for their signals"},
    {"frames_not_data", "remote requests"},
    {"frames_other_page", "another page of a multiplexed message"},
    {"frames_without_partner", "another channel's frame of that instant is missing"},
    {"incomplete", "instants that lacked a channel"},
    {"restarts", "long pauses after which the channels were aligned anew"},
    {"lines_malformed", "malformed lines, skipped on request"},
    {"edges", "edges of the digital lines"},
    {"edges_lost", "edges known to be lost"},
    {"edges_impossible", "edges that followed one of their own direction"},
    {"pulses_implausible", "pulses per second that were not 1 s apart"},
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
