// SPDX-License-Identifier: MIT
#pragma once
#include "app/verbs/simulate.hpp"

namespace dampline::app {

/// Throws UsageError where the options for sending do not fit each other or the rest.
void check_sending(const SimulateOptions& options);

/// Simulates and sends the frames on `options.to`, each sample instant when it is due. Ends early
/// at SIGINT or SIGTERM. An interface that is down or away does not end it: frames that could not
/// be sent are counted. Throws RunError where the interface cannot be opened.
void send_run(const SimulateOptions& options, const SimulatedRun& run);

}  // namespace dampline::app
