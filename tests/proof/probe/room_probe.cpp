// SPDX-License-Identifier: MIT
// Feeds a recorded ride to one room of the core; run under valgrind by room_cost_test.cpp, which
// counts the instructions inside room_measured().
// Usage: room_probe ROOM INSTANTS FIRST
// INSTANTS is a file of Instant structs; those from FIRST on go through room_measured().
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "dampline/effect/diagnosis.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/identifier.hpp"
#include "dampline/phase/view.hpp"
#include "dampline/sample/assembler.hpp"
#include "tests/proof/probe/rooms.hpp"

namespace dampline::proof {
namespace {

class Room {
 public:
  Room() = default;
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;
  virtual ~Room() = default;
  virtual void take(const Instant& instant) = 0;
};

AssemblerConfig assembler_config() {
  AssemblerConfig config;
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].id = 0x310 + static_cast<std::uint32_t>(c);
    config.channels[c].accel = {.length = 12, .is_signed = true, .scale = kCountMps2[c]};
    config.channels[c].has_counter = true;
    config.channels[c].counter = {.start_bit = 12, .length = 12};
  }
  return config;
}

EstimatorConfig identifier_config() {
  EstimatorConfig config;
  config.screen.step_mps2 = kCountMps2;
  return config;
}

GuardConfig guard_config() {
  GuardConfig config;
  config.step_mps2 = kCountMps2;
  return config;
}

struct Decode final : Room {
  SampleAssembler assembler{assembler_config()};
  Sample sample{};
  bool next() noexcept { return assembler.pop(sample); }
  void take(const Instant& instant) override {
    for (const CanFrame& frame : instant.frames) assembler.push(frame);
    while (next()) continue;
  }
};

struct Screen final : Room {
  SampleScreen screen{identifier_config().screen};
  Screened out{};
  void take(const Instant& instant) override {
    static_cast<void>(screen.push(instant.sample, out));
  }
};

struct MotionRoom final : Room {
  Fir<VelocityLift::kHalf> lift{VelocityLift{{}, 300.0}.taps()};
  DriftFreeIntegral velocity{300.0};
  DriftFreeIntegral deflection{300.0};
  double lifted_mps2{0.0};
  double velocity_mps{0.0};
  double deflection_m{0.0};
  void take(const Instant& instant) override {
    const auto& a = instant.sample.accel_mps2;
    if (lift.update(2.0 * a[0] - a[1] - a[2], lifted_mps2) &&
        velocity.update(lifted_mps2, velocity_mps))
      static_cast<void>(deflection.update(velocity_mps, deflection_m));
  }
};

struct Density final : Room {
  FokkerPlanck density{FokkerPlanckConfig{}};
  void take(const Instant& instant) override {
    if (instant.result.has_motion) density.update(instant.result.motion);
  }
};

struct Phase final : Room {
  PhaseView view{PhaseViewConfig{}};
  void take(const Instant& instant) override {
    if (instant.result.has_motion) view.update(instant.result.motion);
  }
};

struct GuardRoom final : Room {
  Guard guard{guard_config()};
  void take(const Instant& instant) override { guard.update(instant.sample); }
};

struct Effect final : Room {
  effect::Diagnosis diagnosis{identifier_config()};
  void take(const Instant& instant) override { diagnosis.update(instant.sample, instant.result); }
};

struct IdentifierRoom final : Room {
  Estimator identifier{identifier_config()};
  void take(const Instant& instant) override {
    static_cast<void>(identifier.update(instant.sample));
  }
};

/// The corridor: frames to the estimate and the densities; as `identify` runs it; as `explain`
/// does.
inline constexpr Parts kChainParts{.guards = false, .phase = false, .alarms = false};
template <Parts kParts>
struct Chain final : Room {
  // How long samples wait costs nothing a sample, and a short wait lets the ride be short.
  BasicIdentifier<kParts> identifier{{.estimator = identifier_config(),
                                      .signals = assembler_config().channels,
                                      .judgement_delay_s = 1.0}};
  void take(const Instant& instant) override {
    for (const CanFrame& frame : instant.frames) identifier.push(frame);
  }
};

/// One snapshot every five seconds.
struct Answer final : Room {
  Estimator identifier{identifier_config()};
  Snapshot snapshot{};
  void take(const Instant& instant) override {
    static_cast<void>(identifier.update(instant.sample));
    if (instant.sample.tick % 1500 == 0) snapshot = identifier.snapshot();
  }
};

std::unique_ptr<Room> open(const char* name) {
  const auto is = [name](const char* other) { return std::strcmp(name, other) == 0; };
  if (is("decode")) return std::make_unique<Decode>();
  if (is("screen")) return std::make_unique<Screen>();
  if (is("motion")) return std::make_unique<MotionRoom>();
  if (is("density")) return std::make_unique<Density>();
  if (is("phase")) return std::make_unique<Phase>();
  if (is("guard")) return std::make_unique<GuardRoom>();
  if (is("effect")) return std::make_unique<Effect>();
  if (is("identifier")) return std::make_unique<IdentifierRoom>();
  if (is("chain")) return std::make_unique<Chain<kChainParts>>();
  if (is("identify")) return std::make_unique<Chain<kIdentifyParts>>();
  if (is("explain")) return std::make_unique<Chain<kExplainParts>>();
  if (is("answer")) return std::make_unique<Answer>();
  return nullptr;
}

}  // namespace
}  // namespace dampline::proof

/// A plain name, so that valgrind can be told it.
extern "C" [[gnu::noinline]] void room_measured(dampline::proof::Room& room,
                                                const dampline::proof::Instant& instant) {
  room.take(instant);
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto room = dampline::proof::open(argv[1]);
  std::FILE* file = std::fopen(argv[2], "rb");
  if (room == nullptr || file == nullptr) return 1;
  const long first = std::atol(argv[3]);
  const auto instant = std::make_unique<dampline::proof::Instant>();
  for (long i = 0; std::fread(instant.get(), sizeof *instant, 1, file) == 1; ++i) {
    if (i >= first) {
      room_measured(*room, *instant);
    } else {
      room->take(*instant);
    }
  }
  std::fclose(file);
  return 0;
}
