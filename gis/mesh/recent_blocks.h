#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace arete {

/// The blocks of a large array that were used last, by index. For one thread.
template <class Block>
class RecentBlocks {
 public:
  using Load = std::function<void(std::int64_t index, Block& block)>;
  using Drop = std::function<void(std::int64_t index, const Block& block)>;

  /// Of `count` blocks `kept` (at least 1) are held. `drop`, where given, is told of each block before it goes.
  RecentBlocks(std::int64_t count, std::int64_t kept, Load load, Drop drop = {})
      : slots_(static_cast<std::size_t>(count)), kept_(kept), load_(std::move(load)), drop_(std::move(drop)) {}

  /// Valid until the next call.
  Block& at(std::int64_t index) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    slot.used = ++clock_;
    if (!slot.block) fetch(index, slot);
    return *slot.block;
  }
  /// Drops all that is held.
  void flush() {
    for (const std::int64_t index : held_) let_go(index);
    held_.clear();
  }

 private:
  struct Slot {
    std::unique_ptr<Block> block;
    std::uint64_t used = 0;
  };

  void let_go(std::int64_t index) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    if (drop_) drop_(index, *slot.block);
    slot.block.reset();
  }
  void fetch(std::int64_t index, Slot& slot) {
    if (static_cast<std::int64_t>(held_.size()) >= kept_) {
      std::size_t oldest = 0;
      for (std::size_t i = 1; i < held_.size(); ++i)
        if (used(held_[i]) < used(held_[oldest])) oldest = i;
      let_go(held_[oldest]);
      held_[oldest] = held_.back();
      held_.pop_back();
    }
    auto block = std::make_unique<Block>();
    load_(index, *block);
    slot.block = std::move(block);
    held_.push_back(index);
  }
  std::uint64_t used(std::int64_t index) const { return slots_[static_cast<std::size_t>(index)].used; }

  std::vector<Slot> slots_;
  std::int64_t kept_;
  Load load_;
  Drop drop_;
  std::vector<std::int64_t> held_;
  std::uint64_t clock_ = 0;
};

}  // namespace arete
