// SPDX-License-Identifier: MIT
#include "app/run/swept.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <string>

namespace dampline::app {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

/// What the handler reads; complete before it is set.
struct Swept {
  std::vector<std::string> folders;
};
Swept swept;                                  // NOLINT(*-non-const-global-variables)
std::atomic<const Swept*> to_sweep{nullptr};  // NOLINT(*-non-const-global-variables)

extern "C" void sweep(int signal) {
  if (const Swept* const found = to_sweep.load(); found != nullptr)
    for (const std::string& folder : found->folders) ::rmdir(folder.c_str());
  ::raise(signal);  // its usual action, since SA_RESETHAND has taken this one away
}

void set_handler(int signal, void (*from)(int), void (*to)(int), int flags) {
  struct sigaction now {};
  ::sigaction(signal, nullptr, &now);
  if (now.sa_handler != from) return;  // NOLINT a union of the system's
  struct sigaction action {};
  action.sa_handler = to;  // NOLINT a union of the system's
  action.sa_flags = flags;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(signal, &action, nullptr);
}

}  // namespace

SweptOnSignal::SweptOnSignal(const std::vector<std::filesystem::path>& folders)
    : first_{to_sweep.load() == nullptr} {
  if (!first_) return;
  swept.folders.clear();
  for (const auto& folder : folders) swept.folders.push_back(folder.string());
  to_sweep = &swept;
  for (const int signal : kSignals)
    set_handler(signal, SIG_DFL, sweep, static_cast<int>(SA_RESETHAND));
}

SweptOnSignal::~SweptOnSignal() {
  if (!first_) return;
  for (const int signal : kSignals) set_handler(signal, sweep, SIG_DFL, 0);
  to_sweep = nullptr;
}

}  // namespace dampline::app
