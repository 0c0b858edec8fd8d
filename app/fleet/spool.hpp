// SPDX-License-Identifier: MIT
// Where a logger keeps the states of its segments until the fleet has them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/state.hpp"

namespace dampline::app::fleet {

/// VEHICLE.TRUCK.START of a segment: the name of its file and the end of its subject. Letters,
/// digits, - and _ stand for themselves, all other bytes are %XX, so that no two segments share a
/// name. START: ns since 1970, with -RECORD where there is no date.
[[nodiscard]] std::string segment_name(const Segment& segment);
/// Of such a name, the part of a vehicle or a truck.
[[nodiscard]] std::string segment_token(std::string_view text);

/// Beside a state that was sent lies STEM.sent, which says which one that was.
[[nodiscard]] bool was_sent(const std::filesystem::path& state);
/// `bytes`: what was sent; the file may hold a later state by now. Throws IoError.
void mark_sent(const std::filesystem::path& state, std::string_view bytes);

/// A folder with a file for each segment, NAME.dls, in whose place each later state of it comes by
/// a rename: whoever reads it, and whoever is killed or loses power, has an old or a new one.
/// Beyond its size, or where the disk is full, the oldest states go that were sent; where that does
/// not suffice for its size, the oldest of all, which is counted.
class Spool {
 public:
  /// Makes the folder. Throws UsageError naming the key where a name of [record] is missing or too
  /// long for a file, and IoError. Precondition: the folder has a name.
  Spool(const SpoolSettings& settings, const RecordLabels& record);

  /// A later state of its segment than all before. What finds no room waits, and is tried again at
  /// the next call: never throws for a disk.
  void put(const Segment& segment, std::string bytes);

  struct Health {
    std::uint64_t failures{0};  ///< times that the disk refused a state
    std::uint64_t dropped{0};   ///< segments that went before they were sent
    std::string error;          ///< of the newest failure
  };
  [[nodiscard]] const Health& health() const noexcept { return health_; }
  /// Segments that have found no room yet.
  [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }
  /// What a reader must know of it; empty: nothing.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  static constexpr std::size_t kMostWaiting = 24;  // segments: some 6 MB, a day

  struct Entry {
    std::pair<std::size_t, std::string> start;  // a number's digits: the order of numbers
    std::filesystem::path file;
    std::uintmax_t bytes{0};
  };
  [[nodiscard]] std::vector<Entry> entries() const;
  void make_room(std::uintmax_t bytes);
  [[nodiscard]] bool disk_has(std::uintmax_t bytes) const;
  void write_waiting();

  std::filesystem::path folder_;
  std::uintmax_t keep_bytes_;
  std::uintmax_t reserve_bytes_;
  std::map<std::string, std::string> waiting_;  // by name
  Health health_;
};

}  // namespace dampline::app::fleet
