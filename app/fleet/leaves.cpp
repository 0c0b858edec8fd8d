// SPDX-License-Identifier: MIT
#include "app/fleet/leaves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tuple>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/database.hpp"
#include "app/run/disk.hpp"
#include "app/text/format.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".dls";

/// A file that was found, or that somebody named.
struct Found {
  fs::path file;
  bool named{false};
};

/// What is being written.
bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

std::vector<Found> find_states(const std::vector<std::string>& sources) {
  std::vector<Found> out;
  for (const std::string& source : sources) {
    std::error_code error;
    const fs::file_status status = fs::status(source, error);
    if (status.type() == fs::file_type::none)
      throw RunError{fmt::format("{}: cannot be read: {}", source, error.message())};
    if (!fs::is_directory(status)) {
      out.push_back({source, true});
    } else if (fs::exists(fs::path{source} / "run.toml", error)) {
      out.push_back({fs::path{source} / "state.dls", true});
    } else {
      for (fs::path& file : files_below(source, is_hidden))
        if (file.extension() == kSuffix) out.push_back({std::move(file), false});
    }
  }
  std::sort(out.begin(), out.end(), [](const Found& a, const Found& b) { return a.file < b.file; });
  return out;
}

/// The one that counts comes first: the order in which all are brought.
auto order(const Leaf& leaf) {
  return std::make_tuple(std::cref(leaf.about.segment), ~leaf.about.sequence, leaf.light,
                         leaf.checksum, std::cref(leaf.file));
}

}  // namespace

Leaf leaf_of(const fs::path& file, std::function<std::string()> read, Statistics& scratch) {
  const std::string bytes = read();
  Leaf leaf;
  leaf.about = decode_state(bytes, file.string(), scratch);
  leaf.header = scratch.header;
  leaf.light = is_light_state(bytes);
  leaf.checksum =
      drivers::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  leaf.file = file;
  leaf.read = std::move(read);
  if (!(leaf.about.moving_mass_kg > 0.0))
    throw RunError{fmt::format(
        "{}: is a state of version 1, which does not say of which segment it is; expected a later "
        "one: identify its record again",
        file.string())};
  return leaf;
}

std::function<std::string()> file_reader(const fs::path& file) {
  return [file] {
    auto bytes = drivers::read_whole(file.string());
    if (!bytes)
      throw RunError{fmt::format(
          "{}; expected a state, a run directory of a truck, a database, or a directory of states",
          bytes.error_text())};
    return std::move(bytes.value());
  };
}

bool comes_before(const Leaf& a, const Leaf& b) { return order(a) < order(b); }

nlohmann::ordered_json to_json(const std::vector<LeftOut>& left_out) {
  auto out = nlohmann::ordered_json::array();
  for (const LeftOut& state : left_out)
    out.push_back({{"state", state.file.string()}, {"reason", state.reason}});
  return out;
}

namespace {

void leave_out(std::vector<Leaf>& leaves, std::vector<LeftOut>& left_out) {
  std::vector<Leaf> kept;
  for (Leaf& leaf : leaves) {
    if (leaf.about.trust == Trust::kDataFaulty) {
      left_out.push_back({leaf.file, "faults of the data spoil it"});
    } else if (!kept.empty() && kept.back().about.segment == leaf.about.segment) {
      left_out.push_back({leaf.file, fmt::format("{} of the segment of {}",
                                                 leaf.about.sequence < kept.back().about.sequence
                                                     ? "an earlier state"
                                                     : "the same state again",
                                                 kept.back().file.string())});
    } else {
      kept.push_back(std::move(leaf));
    }
  }
  leaves = std::move(kept);
}

std::vector<Leaf> all_leaves(const std::vector<std::string>& sources,
                             std::vector<LeftOut>& left_out) {
  std::vector<Leaf> out;
  const auto scratch = std::make_unique<Statistics>();
  for (const Found& found : find_states(sources)) {
    if (is_database(found.file)) {
      std::vector<Leaf> stored = Database{found.file.string(), Database::Access::kRead}.leaves();
      std::move(stored.begin(), stored.end(), std::back_inserter(out));
      continue;
    }
    Leaf leaf = leaf_of(found.file, file_reader(found.file), *scratch);
    if (leaf.about.segments == 1) {
      out.push_back(std::move(leaf));
      continue;
    }
    const std::string what = fmt::format("is itself a merge, of {} segments", leaf.about.segments);
    if (found.named)
      throw RunError{fmt::format(
          "{}: {}: the bytes of a merge depend on its segments alone; expected their states",
          found.file.string(), what)};
    left_out.push_back({found.file, what});
  }
  return out;
}

}  // namespace

std::vector<fs::path> state_files(const std::vector<std::string>& sources) {
  std::vector<fs::path> out;
  for (Found& found : find_states(sources)) out.push_back(std::move(found.file));
  return out;
}

Leaves find_leaves(const std::vector<std::string>& sources) {
  Leaves out;
  out.list = all_leaves(sources, out.left_out);
  std::sort(out.list.begin(), out.list.end(), comes_before);
  leave_out(out.list, out.left_out);
  if (out.list.empty())
    throw RunError{fmt::format("{}: holds no state that can be merged ({} left out)",
                               sources.front(), out.left_out.size())};
  std::sort(out.left_out.begin(), out.left_out.end(),
            [](const LeftOut& a, const LeftOut& b) { return a.file < b.file; });
  const auto unnamed = std::count_if(out.list.begin(), out.list.end(), [](const Leaf& leaf) {
    return leaf.about.segment.vehicle.empty();
  });
  if (unnamed > 0 && out.list.size() > 1)
    out.notes.push_back(fmt::format(
        "{} of {} states name no vehicle and are taken as one car's: [record] vehicle and truck "
        "name it.",
        unnamed, out.list.size()));
  return out;
}

std::string objection(const Leaf& first, const Leaf& leaf) {
  // A rate that is 0.1 % off moves the stiffness by 0.2 %, within the 0.3 % that its deviation has
  // at least (damping/summary.cpp).
  constexpr double kRateApart = 1e-3;
  constexpr double kSure = 3.0;  // deviations
  if (const std::string basis = other_basis(first.header, leaf.header); !basis.empty())
    return "another basis: " + basis;
  const StateAbout& a = first.about;
  const StateAbout& b = leaf.about;
  if (a.moving_mass_kg != b.moving_mass_kg)
    return fmt::format(
        "another mass: [car] moving_mass_kg is {}, expected {}: every force scales with it",
        b.moving_mass_kg, a.moving_mass_kg);
  const double rate = a.rate_hz.value > 0.0 ? a.rate_hz.value : first.header.sample_rate_hz;
  if (b.rate_hz.value > 0.0 && std::abs(b.rate_hz.value / rate - 1.0) > kRateApart)
    return fmt::format("another rate: {:.3f} Hz by its record's own time, expected {:.3f} Hz",
                       b.rate_hz.value, rate);
  for (const auto& [name, value] :
       {std::pair{"friction", b.coulomb_n}, std::pair{"stiffness", b.stiffness_npm}})
    if (value.value + kSure * value.std < 0.0)
      return fmt::format(
          "another sign: its {} comes out negative; are channels exchanged or reversed?", name);
  return "";
}

std::vector<Leaf> check_alike(std::vector<Leaf> leaves, std::vector<LeftOut>* left_out) {
  std::vector<Leaf> out;
  for (Leaf& leaf : leaves) {
    const Leaf& first = out.empty() ? leaf : out.front();
    const std::string why = objection(first, leaf);
    if (why.empty()) {
      out.push_back(std::move(leaf));
      continue;
    }
    if (left_out == nullptr)
      throw RunError{fmt::format("{}: cannot be added to {}: {}; --leave-out goes on without it",
                                 leaf.file.string(), first.file.string(), why)};
    left_out->push_back({leaf.file, why});
  }
  return out;
}

std::vector<std::string> overlaps(std::span<const Leaf> leaves) {
  constexpr std::size_t kMost = 3;
  constexpr double kNotableS = 1.0;
  std::vector<std::string> out;
  std::size_t count = 0;
  const Leaf* latest = nullptr;  // that ends last, of the truck
  for (const Leaf& leaf : leaves) {
    const Segment& segment = leaf.about.segment;
    const bool same_truck = latest != nullptr && latest->about.segment.vehicle == segment.vehicle &&
                            latest->about.segment.truck == segment.truck;
    if (same_truck && segment.start_ns != 0) {
      const double twice_s = 1e-9 * static_cast<double>(latest->about.end_ns - segment.start_ns);
      if (twice_s > kNotableS && ++count <= kMost)
        out.push_back(fmt::format("{} begins {} before {} ends: the same motion counts twice.",
                                  leaf.file.string(), format_duration(twice_s),
                                  latest->file.string()));
    }
    if (!same_truck || leaf.about.end_ns > latest->about.end_ns) latest = &leaf;
  }
  if (count > kMost) out.push_back(fmt::format("{} more overlap.", count - kMost));
  return out;
}

}  // namespace dampline::app::fleet
