// SPDX-License-Identifier: MIT
#include "tests/proof/arrows.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace dampline::proof {
namespace {

/// Headers of std that neither allocate nor throw nor ask the system for anything.
constexpr std::array<std::string_view, 22> kCoreStd{
    "algorithm", "array",    "bit",     "cfloat",  "climits",     "cmath",   "complex",  "concepts",
    "cstddef",   "cstdint",  "cstdlib", "cstring", "limits",      "numbers", "iterator", "new",
    "numeric",   "optional", "span",    "tuple",   "type_traits", "utility"};

/// The rooms of the core. A file includes its own room and those before it, so that they form no
/// circle; the public headers, which lie beside the rooms, belong to all.
constexpr std::array<std::string_view, 12> kCoreRooms{"numeric", "basis", "sample",  "motion",
                                                      "density", "phase", "wavelet", "estimate",
                                                      "damping", "guard", "effect",  "rig"};

struct Room {
  std::string_view name;
  std::vector<std::string_view> may_include;  ///< beginnings of #include names
  bool any_library;                           ///< names of no room are allowed, too
};

/// The first that a path begins with counts: a folder with rules of its own stands before its room.
const std::vector<Room>& rooms() {
  static const std::vector<Room> kRooms{
      {"firmware_core/published/", {"dampline/", "Eigen/", "published/"}, false},
      {"firmware_core/examples/", {"dampline/"}, true},
      {"firmware_core/", {"dampline/", "Eigen/"}, false},
      {"hal/", {"dampline/", "hal/"}, true},
      {"drivers/", {"dampline/", "hal/", "drivers/"}, true},
      {"sim_hw/", {"dampline/", "hal/", "sim_hw/"}, true},
      {"app/verify/", {"dampline/", "published/", "hal/", "sim_hw/", "app/"}, true},
      {"app/wavelet/", {"dampline/", "published/", "hal/", "drivers/", "app/"}, true},
      {"app/diagnosis/", {"dampline/", "hal/", "drivers/", "app/"}, true},
      {"app/", {"dampline/", "hal/", "drivers/", "sim_hw/", "app/"}, true}};
  return kRooms;
}

bool is_ours(std::string_view include) {
  constexpr std::array<std::string_view, 9> kOurs{"dampline/", "published/", "hal/",
                                                  "drivers/",  "sim_hw/",    "app/",
                                                  "tests/",    "bench/",     "firmware_core/"};
  return include.starts_with('.') || std::any_of(kOurs.begin(), kOurs.end(), [&](auto ours) {
           return include.starts_with(ours);
         });
}

bool is_allowed(const Room& room, std::string_view include) {
  if (std::any_of(room.may_include.begin(), room.may_include.end(),
                  [&](auto allowed) { return include.starts_with(allowed); })) {
    return true;
  }
  if (room.any_library) return !is_ours(include);
  return std::find(kCoreStd.begin(), kCoreStd.end(), include) != kCoreStd.end();
}

/// ROOM of "dampline/ROOM/FILE"; empty for the public headers, which lie beside the rooms.
std::string_view core_room(std::string_view name) {
  constexpr std::string_view kCore = "dampline/";
  if (!name.starts_with(kCore)) return {};
  name.remove_prefix(kCore.size());
  return name.substr(0, name.find('/') == name.npos ? 0 : name.find('/'));
}

/// A room that has no place in the order is wrong, too.
bool closes_a_circle(const SourceFile& file, std::string_view include) {
  constexpr std::string_view kFolder = "firmware_core/";
  if (!file.path.starts_with(kFolder)) return false;
  const std::string_view from = core_room(std::string_view{file.path}.substr(kFolder.size()));
  const std::string_view to = core_room(include);
  if (from.empty() || to.empty()) return false;
  const auto* const own = std::find(kCoreRooms.begin(), kCoreRooms.end(), from);
  return own == kCoreRooms.end() || std::find(kCoreRooms.begin(), own + 1, to) == own + 1;
}

}  // namespace

std::vector<std::string> wrong_arrows(const std::vector<SourceFile>& files) {
  std::vector<std::string> wrong;
  for (const SourceFile& file : files) {
    const auto room = std::find_if(rooms().begin(), rooms().end(), [&](const Room& candidate) {
      return file.path.starts_with(candidate.name);
    });
    if (room == rooms().end()) continue;
    for (const std::string& include : includes(file.text)) {
      if (!is_allowed(*room, include) || closes_a_circle(file, include))
        wrong.push_back(file.path + " includes " + include);
    }
  }
  return wrong;
}

}  // namespace dampline::proof
