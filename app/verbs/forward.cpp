// SPDX-License-Identifier: MIT
#include "app/fleet/forward.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "app/error.hpp"
#include "app/live/process.hpp"
#include "app/text/format.hpp"
#include "app/verbs/nats_flags.hpp"
#include "app/verbs/verbs.hpp"

namespace dampline::app {
namespace {

struct ForwardFlags {
  std::vector<std::string> sources;
  fleet::NatsAddress address;
  double every_s{10.0};
  bool once{false};
  bool again{false};
  bool quiet{false};
};

constexpr std::chrono::milliseconds kPatience{10'000};  // for one state, on a slow link

void tell_round(const ForwardFlags& flags, const fleet::Forwarder::Round& round,
                std::string& told) {
  for (const fleet::LeftOut& state : round.refused) warn("refused: " + state.reason);
  // An outage is told once, and its end.
  if (round.error != told && !round.error.empty())
    warn(fmt::format("{} states wait: {}", round.left, round.error));
  if (!flags.quiet && round.sent > 0 && (flags.once || (round.error.empty() && !told.empty())))
    fmt::print("{} states sent\n", round.sent);
  std::fflush(stdout);
  told = round.error;
}

int forward(const ForwardFlags& flags) {
  constexpr std::chrono::milliseconds kTurn{50};
  const StopRequest stop;
  fleet::Forwarder forwarder{flags.sources, flags.address, flags.again};
  std::string told;
  while (!stop.made()) {
    const fleet::Forwarder::Round round = forwarder.round(kPatience);
    if (flags.once && !round.error.empty())
      throw RunError{
          fmt::format("{}: {} states wait: {}", flags.address.url, round.left, round.error)};
    tell_round(flags, round, told);
    if (flags.once) return 0;
    const auto next =
        std::chrono::steady_clock::now() + std::chrono::duration<double>{flags.every_s};
    while (!stop.made() && std::chrono::steady_clock::now() < next)
      std::this_thread::sleep_for(kTurn);
  }
  return 0;
}

}  // namespace

void add_forward_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "forward", "Send a logger's states to the fleet's hub, by NATS, and wait out its outages");
  const auto flags = std::make_shared<ForwardFlags>();
  verb->add_option("SPOOL", flags->sources, "[spool] folder, or other directories of states")
      ->required();
  verb->add_option("--nats", flags->address.url,
                   "nats://HOST:PORT or tls://HOST:PORT of the hub, or of a leaf server before it; "
                   "several by commas")
      ->required();
  add_nats_flags(*verb, flags->address);
  verb->add_option("--every", flags->every_s, "s between two looks at the folder")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  verb->add_flag("--once", flags->once, "send what is there and end; exit code 1 where some waits");
  verb->add_flag("--again", flags->again, "send what was sent already, too: the hub has lost it");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->callback([flags, &action] { action = [flags] { return forward(*flags); }; });
}

}  // namespace dampline::app
