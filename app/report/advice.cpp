// SPDX-License-Identifier: MIT
#include "app/report/advice.hpp"

#include <fmt/format.h>

#include <array>

#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kAnyRig =
    "Check the cable, the plug and the amplifier of that column, and its line in the file.";

constexpr std::array kFaults{
    Advice{"clipping", "A sensor reaches the end of its range",
           "See whether the sensor or its bracket is loose and strikes something. If it is tight, "
           "fit one with a larger "
           "range: 5 g on the frame, 10 g on the wheelsets.",
           "Set the amplifier to a larger range, or fit a sensor with one."},
    Advice{"stuck_channel", "A sensor stands still while the others move",
           "Check its plug, its cable and its supply, from the sensor to the logger. If they are "
           "good, exchange the sensor.",
           kAnyRig},
    Advice{"spikes", "Single wrong values in a channel",
           "Look for a plug that works loose, a chafed cable, a shield that is not earthed, and a "
           "power cable beside it. "
           "The values were replaced by what their neighbours say.",
           kAnyRig},
    Advice{"dc_jump", "The zero of a sensor moved at once",
           "See whether the sensor or its bracket moved or was struck; tighten it. Then check its "
           "supply voltage.",
           kAnyRig},
    Advice{"lost_samples", "Samples were lost on the way",
           "Check the plugs of the bus and its two terminating resistors (60 ohm between CAN_H and "
           "CAN_L with the supply "
           "off), then how busy the bus and the logger are.",
           "See whether the recorder's disk or computer keeps up."},
    Advice{"repeated_samples", "Samples came twice",
           "See whether a gateway, a second logger or a replay sends the same frames again.",
           "See whether the file was joined from pieces that overlap."},
    Advice{"timing_step", "A sensor is later or earlier from one moment on",
           "See whether its node restarted: check its plug and supply, and that its filter and "
           "rate are those of the others.",
           "See whether that channel was restarted, or recorded by another device."},
    Advice{"clock_drift", "A sensor has a clock of its own",
           "Connect the line or the message that keeps the nodes in step, or read all three "
           "sensors by one node.",
           "Record all columns by one device."},
    Advice{"gain_change", "The sensitivity of a sensor changed",
           "Check how the sensor is fastened and whether it gets hot. Turn it over by hand: it "
           "must show 9.81 m/s^2 up and "
           "as much down. If not, exchange it.",
           kAnyRig},
    Advice{"soft_saturation", "A sensor shows less the more it is shaken",
           "Check that its bracket is stiff and tight and no rubber lies under it; then fit a "
           "sensor with a larger range.",
           kAnyRig},
    Advice{"excess_noise", "A sensor is noisier than it should be",
           "Check the shield and its earth, the supply, and whether a cable is chafed or lies "
           "beside a power cable. If all "
           "is well, exchange the sensor.",
           kAnyRig},
    Advice{
        "noise_burst", "A sensor is noisy at times",
        "Look for a loose plug or a cable that rubs, and for what was switched on at these times.",
        kAnyRig},
    Advice{"resolution_loss", "The lowest digits of a sensor do not move",
           "Check the range that the sensor node is set to and the scale in the DBC file: 12 bits "
           "or better are needed.",
           "Set the amplifier to a smaller range, or write more digits to the file."},
    Advice{"swapped_channels", "Two sensors are exchanged",
           "Compare plugs and labels: which sensor sits on the frame, which on wheelset 1 and 2? "
           "Knock on each and watch "
           "which signal moves. Then mend the plugs or the configuration.",
           "Compare the names of the columns with the wiring."},
    Advice{"wrong_polarity", "A sensor is upside down",
           "Up must be positive on all three. Turn the sensor over, or turn the sign of its signal "
           "in the configuration.",
           "Turn the sign of that column in the configuration."},
    Advice{"wrong_sample_rate", "The rate, the wheelbase or the speed is not what was stated",
           "Measure the wheelbase of the truck, and compare the rate of the sensor nodes and the "
           "speed with the "
           "configuration.",
           "Compare the rate of the recorder with the configuration."},
    Advice{"identical_channels", "Two channels show the same, digit for digit",
           "One sensor is connected twice, or one signal is named twice in the configuration. "
           "Knock on each sensor and watch "
           "which signal moves.",
           "One column is there twice."},
    Advice{
        "jitter", "Samples are taken at uneven times",
        "Each sensor samples when its own program gets to it, or stamps say when a frame came, not "
        "when it was sampled. Let the sensors sample by one clock, or by a timer of their own, "
        "and number the frames.",
        "See how the recorder times its samples."},
    Advice{"ringing_mount", "What a sensor is mounted on rings",
           "Knock on the sensor's bracket: it must not sound. Mount the sensor on the frame or the "
           "axle box itself, or on a bracket that is stiff beyond half the sampling rate.",
           kAnyRig},
    Advice{"off_centre", "The frame's sensor does not sit over the middle",
           "Mount it half way between the wheelsets, or add a second one over the frame's end and "
           "state it in the configuration.",
           kAnyRig},
    Advice{"foreign_motion", "These three sensors do not tell the motion of this truck",
           "Are all three on the same side, upright, and on the same truck? Does the truck hunt? "
           "Sensors on both sides, or one where the frame does not roll, tell more.",
           kAnyRig},
    Advice{
        "wrong_low_pass", "The sensors' low pass is not what was stated",
        "The size is where it seems to lie. See the sensors' data sheets and what the logger was "
        "set to, and state [input.anti_alias] corner_hz, or that sensor's own.",
        kAnyRig},
    Advice{"wrong_value", "Single wrong values in a column", "", kAnyRig},
    Advice{"wrong_time", "Lines whose time is out of order", "",
           "See whether the file was joined from pieces, or the recorder's clock was set while it "
           "ran."}};

constexpr std::array kEffects{
    Advice{"viscous", "Damping that grows with speed",
           "Is a hydraulic damper fitted beside the friction? If none is, look for grease, oil or "
           "water on the friction "
           "surfaces.",
           "Look for oil, rubber or air that is squeezed beside the friction."},
    Advice{"asymmetric_viscous", "Damping that grows with speed, otherwise up than down",
           "Check a hydraulic damper for leaks and for a valve that hangs: it works in one "
           "direction only.",
           "Check the damper's valves: both directions differ."},
    Advice{"quadratic_damping", "Damping that grows with the square of speed",
           "Check a hydraulic damper for a blocked bore or thick oil.",
           "Look for oil or air forced through a narrow bore."},
    Advice{
        "viscoelastic", "A spring behind a dashpot: stiffer and damped the faster it moves",
        "Look for rubber in the suspension (pads, bushes, liners), or a hydraulic damper on soft "
        "mounts.",
        "Look for rubber, or a hydraulic damper on soft mounts."},
    Advice{"progressive_damping", "Damping that grows with the square of deflection",
           "No effect of a truck: look at what drives or holds the suspension.",
           "Below zero about the middle it drives the motion: look for what feeds it (a control, a "
           "flow)."},
    Advice{"progressive_friction", "Friction that grows with deflection",
           "Load-dependent friction (wedges, links) works: this is its design. Where it should be "
           "constant, check wedges, "
           "wear plates and their springs for wear on one side.",
           "Look for surfaces that are pressed together the more the further they move."},
    Advice{"stribeck", "Friction that falls with speed",
           "The friction surfaces stick and slip: look for polish, rust or grease on wedges and "
           "wear plates; listen for "
           "squeal.",
           "Look for polished or greased friction surfaces."},
    Advice{"presliding_hysteresis", "Friction that builds up over a distance after each reversal",
           "Something gives before it slides: check liners, rubber pads and bushes at the friction "
           "surfaces, and brackets "
           "that bend.",
           "Something gives before it slides: a mount, a joint or a pad."},
    Advice{"backlash", "Free play: no friction until a gap is taken up",
           "Look for wear between the friction wedge and its pocket, in pins, bushes and the "
           "guides of the axle boxes; "
           "measure their play with a feeler gauge.",
           "Check the clamping and the joints of the damper for play."},
    Advice{"bump_stop", "Contact beyond a gap",
           "The suspension strikes a stop: check the load, the height of the springs and broken "
           "coils, and look for bright "
           "marks on stops and side bearers.",
           "The motion reaches a stop."},
    Advice{"cubic_stiffness", "A spring that hardens with deflection",
           "Look for coils that close, springs of two stages, and rubber that is pressed flat. "
           "Springs of a design that "
           "hardens do this.",
           "The spring hardens: look for coils that close or rubber that is pressed flat."},
    Advice{"quadratic_stiffness", "A spring that is stiffer one way than the other",
           "Look for broken or exchanged coils, springs of two stages, and a load beyond what the "
           "springs are made for.",
           "The spring is stiffer one way: check its seat and its preload."},
    Advice{"asymmetric_stiffness", "A spring that changes its stiffness at the middle",
           "A second spring comes into play at the height of rest: check the nest for broken, "
           "missing or exchanged coils.",
           "A second spring comes into play at the middle: check seats and preload."},
    Advice{
        "unmodelled_mode", "Something else swings",
        "The frame pitches, or a part swings of its own: check that the frame's sensor sits in the "
        "middle of the frame, "
        "and look for loose brake gear and brackets. A frame-end sensor takes pitch into account.",
        "A part of the rig swings of its own: look for loose or soft mounts at that frequency."},
    Advice{"other_truck", "The other truck pushes through the body",
           "Nothing is wrong: both trucks carry one body, and this is taken into account. A sensor "
           "on the other truck's frame makes it surer.",
           kAnyRig},
    Advice{"time_skew", "A sensor is late",
           "Compare filter and rate of the sensor nodes: they must be the same in all three. For a "
           "file the delay was set "
           "right.",
           "One column is later than the others: compare the filters and the recorder's channels."},
    Advice{"gain_error", "A sensor shows too much or too little",
           "Turn the sensor over by hand: it must show 9.81 m/s^2 up and as much down. Check its "
           "scale in the DBC file, and "
           "that it stands upright.",
           "Check the calibration of the columns for motion against each other."},
    Advice{"impulsive_input", "Blows that no sensor measures",
           "Look for wheel flats, and for parts that strike the frame: brake gear, side bearers, "
           "loose load.",
           "Something strikes the rig: look for loose parts."},
    Advice{"cross_axis", "A sensor is tilted",
           "Check that every sensor stands upright: it must show 9.81 m/s^2 up and as much down "
           "when it is turned over.",
           "Check that the sensors of motion and force point along the motion."},
    Advice{"unknown", "Something real that has no name",
           "The signature below says whether it goes with deflection, speed, frequency or time. "
           "Inspect the suspension for "
           "what is unlike its sister truck, then record again.",
           "The signature below says whether it goes with deflection, speed, frequency or time."},
    Advice{"time_drift", "Friction, stiffness or mass changed during the record",
           "Was the car loaded or unloaded, wet or iced up? If not, look for a broken spring or a "
           "wedge that came loose at "
           "that time; compare with a second record.",
           "See whether the damper warmed up, ran in or came loose."},
    Advice{"coulomb", "Dry friction that was not expected", "",
           "Look for seals, guides and bearings that rub."},
    Advice{"asymmetric_coulomb", "Friction that differs by direction", "",
           "Look for a clamp or a wedge that is set otherwise for the two directions."},
    Advice{"offset_force", "A constant force", "",
           "Set the zero of the force sensor, or take the weight out of the force."}};

const Advice* advice_on(std::string_view name) {
  for (const std::span<const Advice> table : {fault_advice(), effect_advice()})
    for (const Advice& advice : table)
      if (advice.name == name) return &advice;
  return nullptr;
}

/// What was found, how large it is, and where to look.
std::string check_item(const std::string& name, const std::string& found, bool truck) {
  const Advice* const advice = advice_on(name);
  const std::string_view text = advice == nullptr ? "" : truck ? advice->truck : advice->rig;
  return fmt::format(
      "<div class=\"check\"><h3>{}</h3>\n{}{}</div>\n",
      advice == nullptr ? escape_html(plot_label(name)) : escape_html(advice->title),
      found.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", escape_html(found)),
      text.empty() ? "" : fmt::format("<p>{}</p>\n", escape_html(text)));
}

std::string found_fault(const FaultFinding& fault) {
  std::string out = fault.channel + ", from " + format_duration(fault.time_s);
  if (fault.last_s > fault.time_s) out += " to " + format_duration(fault.last_s);
  const std::string size = fault_size(fault);
  return out + " of the record" + (size.empty() ? "" : ", " + size);
}

std::string found_effect(const LackingEffect& effect, bool truck) {
  std::string out;
  for (const Parameter& p : effect.parameters) {
    if (p.value == 0.0 && p.std == 0.0) continue;
    const bool own = p.name.starts_with(effect.name + "_");  // the title says it
    out += fmt::format("{}{}: {}", out.empty() ? "" : "; ",
                       plot_label(own ? p.name.substr(effect.name.size() + 1) : p.name),
                       quantity_text(p.value, p.std, p.unit));
    // y = 2 z_b - (z_1 + z_2) is twice the travel of a spring.
    if (truck && p.unit == "m")
      out += fmt::format(" in y, {:.2g} mm between frame and wheelset", 0.5e3 * p.value);
  }
  return out;
}

std::string nothing_to_check(const RunResult& result, const Finding& finding) {
  const std::string faults = "No fault of a sensor or of the transport was found";
  if (finding.verdict == "complete")
    return faults + ", and the suspension has nothing that the model lacks.";
  if (result.trust != Trust::kTrusted)
    return faults + ". Why the numbers are not to be trusted stands above.";
  return faults +
         ". Effects of the suspension that the model may lack are looked for by dampline explain.";
}

}  // namespace

std::span<const Advice> fault_advice() noexcept { return kFaults; }
std::span<const Advice> effect_advice() noexcept { return kEffects; }

std::string advice_section(const RunResult& result) {
  const bool truck = result.kind == "truck";
  Finding finding = finding_of(result.evidence);
  if (finding.verdict.empty())  // a live result
    for (const std::string& name : result.lacking) finding.effects.push_back({name, {}});
  std::string out;
  for (const FaultFinding& f : result.faults.list) out += check_item(f.name, found_fault(f), truck);
  for (const LackingEffect& e : finding.effects)
    out += check_item(e.name, found_effect(e, truck), truck);
  // Beside faults that change the numbers, what is left is theirs.
  const bool is_left = finding.verdict == "unexplained" || finding.verdict == "partly_explained";
  if (is_left && result.trust != Trust::kDataFaulty)
    out +=
        check_item("unknown", finding.signature.empty() ? "" : "left: " + finding.signature, truck);
  if (result.faults.drift)
    out += check_item("time_drift", describe_drift(*result.faults.drift), truck);
  for (const AlarmFinding& a : result.faults.alarms)
    out += check_item("time_drift", describe_alarm(a), truck);
  if (!out.empty()) return out;
  return fmt::format("<p>{}</p>\n", escape_html(nothing_to_check(result, finding)));
}

}  // namespace dampline::app
