#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace sweepgrid {

/// How much memory a list may keep that every step fills anew: twice the most that one of the latest 64 steps used. So
/// a scene that repeats itself within 64 steps allocates nothing, and what a crowded step took goes back soon after it.
///
/// Keeps the three greatest uses that no later one reached. That tells the most of 64 steps exactly unless uses fall
/// step after step; then it may tell that of an older step, at most 128 steps old. 16 bytes; O(1) for each step.
class HighWater {
 public:
  static constexpr std::uint8_t kSteps = 64;

  /// Ends a step that used `used` elements: to be called once in every step, idle ones included.
  void note(std::size_t used) {
    for (std::uint8_t i = 0; i < count_; ++i) ++ages_[i];
    if (count_ > 0 && ages_[0] >= kSteps) {
      std::copy(uses_.begin() + 1, uses_.end(), uses_.begin());
      std::copy(ages_.begin() + 1, ages_.end(), ages_.begin());
      --count_;
    }
    const std::uint32_t parts = parts_of(used);
    while (count_ > 0 && parts >= uses_[count_ - 1]) --count_;
    if (count_ < uses_.size()) uses_[count_++] = parts;
    ages_[count_ - 1] = 0;
  }

  /// note() for so many steps at once that all used as much.
  void pass(std::size_t steps, std::size_t used = 0) {
    for (std::size_t step = std::min<std::size_t>(steps, 2 * kSteps); step > 0; --step) note(used);
  }

  /// The most that one of the latest steps used, rounded up to a multiple of 16.
  [[nodiscard]] std::size_t most() const {
    if (count_ == 0) return 0;
    if (uses_[0] == kEndless) return std::numeric_limits<std::size_t>::max() / 2;
    return std::size_t{uses_[0]} * kPart;
  }
  /// Elements that the list may keep memory for.
  [[nodiscard]] std::size_t allowed() const { return 2 * most(); }

  /// note() for a list of which nothing is needed any more: it is emptied, and keeps its memory if it may. Else all of
  /// it goes back, for to allocate less could fail. `used`: if it was once longer in this step than it is now.
  template <class List>
  void recycle(List& list, std::size_t used = 0) {
    note(std::max(used, list.size()));
    release(list);
  }
  /// recycle() without note(), for lists that share what is noted.
  template <class List>
  void release(List& list) const {
    list.clear();
    if (list.capacity() > allowed()) List().swap(list);
  }

 private:
  // So that 32 bits suffice. Lists of a few elements keep their memory until 64 steps used none of it.
  static constexpr std::size_t kPart = 16;
  static constexpr std::uint32_t kEndless = std::numeric_limits<std::uint32_t>::max();

  static std::uint32_t parts_of(std::size_t used) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(used / kPart + (used % kPart != 0 ? 1 : 0), kEndless));
  }

  std::array<std::uint32_t, 3> uses_{};  // falling
  std::array<std::uint8_t, 3> ages_{};   // of each: steps since
  std::uint8_t count_ = 0;
};

static_assert(sizeof(HighWater) == 16);

}  // namespace sweepgrid
