// SPDX-License-Identifier: MIT
// The states that a merge is made of, in the one order that its bytes depend on.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/run/state.hpp"

/// Many runs: what `merge`, `archive` and `collect` share.
namespace dampline::app::fleet {

/// The state of one segment, where it lies.
struct Leaf {
  StateAbout about;
  StatisticsHeader header;
  bool light{false};
  std::uint32_t checksum{0};          ///< CRC-32C of the file
  std::filesystem::path file;         ///< or what errors call it
  std::function<std::string()> read;  ///< its bytes again; throws RunError
};

/// Of bytes that are read, and can be read again. Throws RunError naming `file` for no state, or
/// one without a segment (version 1). `scratch` saves memory.
[[nodiscard]] Leaf leaf_of(const std::filesystem::path& file, std::function<std::string()> read,
                           Statistics& scratch);
/// A state where it lies.
[[nodiscard]] std::function<std::string()> file_reader(const std::filesystem::path& file);

/// Which of two states comes first: by segment; of one segment the one that counts.
[[nodiscard]] bool comes_before(const Leaf& a, const Leaf& b);

/// A state that is not in the merge, and why.
struct LeftOut {
  std::filesystem::path file;
  std::string reason;
};

/// [{"state", "reason"}, ...], as merge, archive and collect print it.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<LeftOut>& left_out);

struct Leaves {
  std::vector<Leaf> list;          ///< in the order of their segments, each segment once
  std::vector<LeftOut> left_out;   ///< in the order of their names
  std::vector<std::string> notes;  ///< what a reader must know of them
};

/// The files of states at `sources`, in the order of their names. Throws RunError for a directory
/// that cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> state_files(
    const std::vector<std::string>& sources);

/// Of each source, a state, a run directory, a database or a directory of states and runs to any
/// depth. Left out
/// are earlier states of a segment (by sequence; where it is the same, light before full, then
/// those with the larger checksums), what faults of the data spoil, and in directories what is
/// itself a merge. Throws RunError naming a state that is damaged, has no segment (version 1) or is
/// given by name and is a merge, and where no state is left.
[[nodiscard]] Leaves find_leaves(const std::vector<std::string>& sources);

/// Why `leaf` cannot be added to those before it, of which `first` is one: another basis, mass or
/// measured rate, or friction or a spring of the other sign; empty: it can.
[[nodiscard]] std::string objection(const Leaf& first, const Leaf& leaf);

/// Throws RunError with the reason at the first that cannot be added; with `left_out` it goes there
/// instead, and what remains is returned.
[[nodiscard]] std::vector<Leaf> check_alike(std::vector<Leaf> leaves,
                                            std::vector<LeftOut>* left_out);

/// Whether two segments of one truck overlap in time: "STATE begins 12 min before OTHER ends ...",
/// a sentence for each, at most a few.
[[nodiscard]] std::vector<std::string> overlaps(std::span<const Leaf> leaves);

}  // namespace dampline::app::fleet
