// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/error.hpp"
#include "app/fleet/database.hpp"
#include "app/fleet/leaves.hpp"
#include "app/fleet/nats/nats.hpp"
#include "app/live/process.hpp"
#include "app/run/json.hpp"
#include "app/text/format.hpp"
#include "app/verbs/nats_flags.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct CollectFlags {
  std::vector<std::string> sources;
  std::string database;
  fleet::NatsAddress address;
  std::string consumer;
  bool follow{false};
  bool again{false};
  bool json{false};
  bool quiet{false};
};

struct Collected {
  std::uint64_t fresh{0};
  std::uint64_t later{0};
  std::uint64_t known{0};
  std::uint64_t merges{0};  ///< passed over
  std::vector<fleet::LeftOut> refused;
};

/// A state that was read. Throws RunError for what is none, or what `subject`, where there is one,
/// may not carry: who may send on it may not speak for others.
void collect_state(fleet::Database& database, const std::string& origin, const std::string& bytes,
                   const std::string& subject, Statistics& scratch, Collected& out) {
  const fleet::Leaf leaf = fleet::leaf_of(
      origin, [&bytes] { return bytes; }, scratch);
  if (!subject.empty() && fleet::subject_of(leaf.about.segment) != subject)
    throw RunError{fmt::format("{}: came on subject {}, expected {}", origin, subject,
                               fleet::subject_of(leaf.about.segment))};
  if (leaf.about.segments > 1) {
    ++out.merges;
    return;
  }
  switch (database.put(leaf, bytes)) {
    case fleet::Stored::kNew:
      ++out.fresh;
      break;
    case fleet::Stored::kLater:
      ++out.later;
      break;
    case fleet::Stored::kKnown:
      ++out.known;
      break;
  }
}

/// `read`: its bytes. What is refused is kept as such.
template <class Read>
void collect_or_refuse(fleet::Database& database, const std::string& origin, const Read& read,
                       const std::string& subject, Statistics& scratch, Collected& out) {
  try {
    collect_state(database, origin, read(), subject, scratch, out);
  } catch (const RunError& error) {
    database.refuse(origin, error.what());
    out.refused.push_back({origin, error.what()});
  }
}

void collect_files(fleet::Database& database, const std::vector<std::string>& sources,
                   Statistics& scratch, Collected& out) {
  constexpr std::size_t kTogether = 200;  // states in one transaction
  const std::vector<std::filesystem::path> files = fleet::state_files(sources);
  for (std::size_t begin = 0; begin < files.size(); begin += kTogether) {
    database.begin();
    for (std::size_t i = begin; i < std::min(begin + kTogether, files.size()); ++i)
      collect_or_refuse(database, files[i].string(), fleet::file_reader(files[i]), "", scratch,
                        out);
    database.commit();
  }
}

/// Until nothing comes, or where it is to be followed, until a signal. The hub hears of what is
/// kept when the database has it.
void take_from_hub(fleet::Database& database, const CollectFlags& flags, fleet::NatsReceiver& hub,
                   const StopRequest& stop, Statistics& scratch, Collected& out) {
  constexpr int kTogether = 64;  // states in one transaction: 16 MB
  constexpr std::chrono::milliseconds kPatience{1000};
  while (!stop.made()) {
    const std::vector<fleet::NatsMessage> messages = hub.fetch(kTogether, kPatience);
    if (messages.empty() && !flags.follow) return;
    if (messages.empty()) continue;
    database.begin();
    for (const fleet::NatsMessage& message : messages)
      collect_or_refuse(
          database, "nats:" + message.subject, [&message] { return message.bytes; },
          message.subject, scratch, out);
    database.commit();
    hub.confirm();
  }
}

void collect_from_hub(fleet::Database& database, const CollectFlags& flags, const std::string& url,
                      Statistics& scratch, Collected& out) {
  constexpr std::chrono::seconds kPause{2};
  const StopRequest stop;
  fleet::NatsAddress address = flags.address;
  address.url = url;
  // An empty database wants everything, whatever one of its name had before.
  bool again = flags.again || database.states() == 0;
  std::string told;
  while (!stop.made()) {
    try {
      fleet::NatsReceiver hub{address, flags.consumer, again};
      again = false;
      return take_from_hub(database, flags, hub, stop, scratch, out);
    } catch (const fleet::NatsError& error) {
      if (!flags.follow) throw;
      if (told != error.what()) warn(error.what());
      told = error.what();
    }
    std::this_thread::sleep_for(kPause);
  }
}

void print_collected(const CollectFlags& flags, const fleet::Database& database,
                     const Collected& c) {
  if (flags.json) {
    fmt::print("{}", json_text({{"schema", "dampline.collect/1"},
                                {"states_new", c.fresh},
                                {"states_later", c.later},
                                {"states_known", c.known},
                                {"merges_passed_over", c.merges},
                                {"refused", fleet::to_json(c.refused)},
                                {"segments", database.states()}}));
    return;
  }
  if (flags.quiet) return;
  fmt::print("{} new, {} later, {} known; {} segments in {}\n", c.fresh, c.later, c.known,
             database.states(), drivers::printable(database.connection().name()));
}

int collect(const CollectFlags& flags) {
  fleet::Database database{flags.database, fleet::Database::Access::kWrite};
  const auto scratch = std::make_unique<Statistics>();
  Collected out;
  std::vector<std::string> files;
  for (const std::string& source : flags.sources)
    if (!fleet::is_nats(source)) files.push_back(source);
  if (!files.empty()) collect_files(database, files, *scratch, out);
  for (const std::string& source : flags.sources)
    if (fleet::is_nats(source)) collect_from_hub(database, flags, source, *scratch, out);
  print_collected(flags, database, out);
  for (const fleet::LeftOut& state : out.refused) warn("refused: " + state.reason);
  return 0;
}

/// Of two databases the consumers must differ: each would get what the other lacks.
std::string consumer_of(const std::string& database) {
  const std::string place = database.find("://") == std::string::npos
                                ? std::filesystem::absolute(database).lexically_normal().string()
                                : database;
  const std::span<const char> text{place};
  return fmt::format(
      "collect-{:08x}",
      drivers::crc32c({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
}

}  // namespace

void add_collect_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "collect", "States that cars have sent or left on a disk, into one database of the fleet");
  const auto flags = std::make_shared<CollectFlags>();
  verb->add_option("STATE", flags->sources,
                   "states, run directories of trucks, or directories of these: a spool, a stick; "
                   "nats://HOST:PORT or tls://HOST:PORT: what loggers forward to that hub")
      ->required();
  verb->add_option(
          "--db", flags->database,
          "SQLite's file, made where it is missing, or postgresql://...; `dampline merge` of "
          "either merges it")
      ->required();
  add_nats_flags(*verb, flags->address);
  verb->add_option(
      "--consumer", flags->consumer,
      "of a hub: by which it knows what this database has confirmed; by default a name "
      "made from --db");
  verb->add_flag("--follow", flags->follow, "of a hub: go on with what comes, until a signal");
  verb->add_flag("--again", flags->again,
                 "of a hub: take all that it holds once more: the database lost some");
  verb->add_flag("--json", flags->json, "print what was done as JSON");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->callback([flags, &action] {
    if (flags->consumer.empty()) flags->consumer = consumer_of(flags->database);
    action = [flags] { return collect(*flags); };
  });
}

}  // namespace dampline::app
