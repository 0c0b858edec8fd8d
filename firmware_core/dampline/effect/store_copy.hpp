// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>

#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {

/// A copy of a store's entries beside its updates, one matrix a step, so that no sample pays for
/// all of it. The copy is of one moment: when the store changes meanwhile, it begins anew.
class StoreCopy {
 public:
  void start() noexcept { part_ = 0; }
  /// The next part; true when the copy is whole.
  bool step(const GramStore& from) noexcept {
    if (part_ == 0 || from.revision() != revision_) {
      revision_ = from.revision();
      part_ = 0;
    }
    if (from.is_changing()) {
      part_ = 0;
      return false;
    }
    if (part_ < from.parts()) copy_.copy_part(from, part_++);
    return part_ == from.parts();
  }
  [[nodiscard]] const GramStore& store() const noexcept { return copy_; }

 private:
  std::size_t part_{0};
  std::uint64_t revision_{0};
  GramStore copy_;
};

}  // namespace dampline::effect
