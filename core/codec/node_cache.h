#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

namespace arete {

/// The nodes of a tree that were decoded last, by index: windows near one another, and the coarse levels of all windows, are decoded
/// once. Safe to use from several threads. A node that two threads miss at the same time is decoded by both.
template <class Node>
class NodeCache {
 public:
  /// Keeps so many bytes; 0: nothing.
  explicit NodeCache(std::int64_t limit_bytes) : limit_(limit_bytes) {}

  /// Whether it is kept; if so, `node` is set (to null where it was kept as null).
  bool find(std::int64_t index, std::shared_ptr<const Node>& node) {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    const auto found = by_index_.find(index);
    if (found == by_index_.end()) return false;
    kept_.splice(kept_.begin(), kept_, found->second);
    node = found->second->node;
    return true;
  }

  /// `bytes`: what the node takes. The nodes used longest ago make room.
  void keep(std::int64_t index, std::shared_ptr<const Node> node, std::int64_t bytes) {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    bytes += overhead;
    if (bytes > limit_ || by_index_.contains(index)) return;
    kept_.push_front({index, bytes, std::move(node)});
    by_index_.emplace(index, kept_.begin());
    held_ += bytes;
    while (held_ > limit_) {
      held_ -= kept_.back().bytes;
      by_index_.erase(kept_.back().index);
      kept_.pop_back();
    }
  }

 private:
  static constexpr std::int64_t overhead = 128;  // of an entry
  struct Entry {
    std::int64_t index = 0;
    std::int64_t bytes = 0;
    std::shared_ptr<const Node> node;
  };
  std::mutex one_at_a_time_;
  std::int64_t limit_;
  std::int64_t held_ = 0;
  std::list<Entry> kept_;  // the last used first
  std::unordered_map<std::int64_t, typename std::list<Entry>::iterator> by_index_;
};

}  // namespace arete
