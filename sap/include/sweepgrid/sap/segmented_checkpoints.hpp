#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>

namespace sweepgrid {

/// S3: for each segment of one axis exactly the objects whose interval spans the segment's trailing edge, that is,
/// whose min lies in it or to its left and whose max lies to its right. Unordered, no duplicates. Lets an insert see
/// boxes whose endpoints lie arbitrarily far away (section 3.2.2).
class SegmentedCheckpoints {
 public:
  using SegmentId = std::uint32_t;

  /// Segments have ids below `bound`; new ones have empty sets.
  void resize(std::size_t bound) { sets_.resize(bound); }

  [[nodiscard]] const std::vector<Slot>& members(SegmentId segment) const { return sets_[segment]; }

  /// Takes back a deferred leave, if there is one.
  void enter(SegmentId segment, Slot slot) {
    const auto deferred = std::find(deferred_.begin(), deferred_.end(), std::pair{segment, slot});
    if (deferred == deferred_.end()) {
      sets_[segment].push_back(slot);
    } else {
      *deferred = deferred_.back();
      deferred_.pop_back();
    }
  }

  /// Deferred until it enters, if it is no member.
  void leave(SegmentId segment, Slot slot) {
    std::vector<Slot>& set = sets_[segment];
    const std::size_t place = find(set, slot);
    if (place == set.size()) {
      deferred_.emplace_back(segment, slot);
    } else {
      set[place] = set.back();
      set.pop_back();
    }
  }

  /// All of `slots` enter.
  template <class Slots>
  void append(SegmentId segment, const Slots& slots) {
    sets_[segment].insert(sets_[segment].end(), slots.begin(), slots.end());
  }

  /// Those members leave of whom `gone(slot)` holds.
  template <class Gone>
  void erase_if(SegmentId segment, Gone gone) {
    std::erase_if(sets_[segment], gone);
  }

  void copy(SegmentId from, SegmentId to) { sets_[to] = sets_[from]; }

  /// Gives the set of `from` to `to`; `from` gets none.
  void hand_over(SegmentId from, SegmentId to) {
    sets_[to].swap(sets_[from]);
    sets_[from].clear();
  }

  /// Whether all who left had entered: so it is between objects.
  [[nodiscard]] bool settled() const { return deferred_.empty(); }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = sets_.capacity() * sizeof(sets_[0]) + deferred_.capacity() * sizeof(deferred_[0]);
    for (const auto& set : sets_) total += set.capacity() * sizeof(Slot);
    return total;
  }

 private:
  // Without an exit from the loop, so that it becomes vectors: sets hold what a plane cuts, a hundred and more.
  static std::size_t find(const std::vector<Slot>& set, Slot slot) {
    const auto count = static_cast<std::uint32_t>(set.size());
    std::uint32_t place = count;
    for (std::uint32_t i = 0; i < count; ++i) place = set[i] == slot ? i : place;
    return place;
  }

  std::vector<std::vector<Slot>> sets_;

  /// The paper's set R: sets that the object in flight left before it entered, because its trailing endpoint overtook
  /// the leading one.
  std::vector<std::pair<SegmentId, Slot>> deferred_;
};

}  // namespace sweepgrid
