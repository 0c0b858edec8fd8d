// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace dampline::drivers {

/// Names of the interfaces of a log, numbered as they appear. Room for 255; nothing is allocated.
class InterfaceTable {
 public:
  static constexpr std::size_t kMost = 255;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] std::string_view name(std::size_t index) const noexcept {
    return {names_[index].text.data(), names_[index].length};
  }
  /// Nothing when the table is full. Precondition: name has at most 15 characters.
  [[nodiscard]] std::optional<std::uint8_t> index_of(std::string_view name) noexcept {
    if (latest_ < count_ && this->name(latest_) == name) return latest_;
    for (std::size_t i = 0; i < count_; ++i) {
      if (this->name(i) != name) continue;
      latest_ = static_cast<std::uint8_t>(i);
      return latest_;
    }
    if (count_ == kMost) return std::nullopt;
    std::memcpy(names_[count_].text.data(), name.data(), name.size());
    names_[count_].length = name.size();
    latest_ = static_cast<std::uint8_t>(count_++);
    return latest_;
  }

 private:
  struct Name {
    std::array<char, 16> text{};
    std::size_t length{0};
  };
  std::array<Name, kMost> names_{};
  std::size_t count_{0};
  std::uint8_t latest_{0};  // most frames come from the interface of the frame before
};

}  // namespace dampline::drivers
