#pragma once

#include <cstddef>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// Items of which every step uses some number, from the first one on, each with lists that it fills anew. Those that
/// are not used keep their memory as HighWater allows.
///
/// `Item` has note_step(), to be called by whoever used it when the step no longer needs its lists; pass(steps), which
/// is the same for steps in which it was not used; and bytes().
template <class Item>
class StepItems {
 public:
  /// Begins a step: none is used yet.
  void restart() { used_ = 0; }
  /// Ends the step. Those that it used stay as they are.
  void finish() {
    for (std::size_t i = used_; i < items_.size(); ++i) items_[i].pass(1);
    most_.note(used_);
    release();
  }
  /// As restart() and finish() for so many steps in which none was used.
  void pass(std::size_t steps) {
    used_ = 0;
    for (Item& item : items_) item.pass(steps);
    most_.pass(steps);
    release();
  }

  /// Uses one more. `make`: what makes it where there is none yet.
  template <class Make>
  Item& add(Make&& make) {
    if (used_ == items_.size()) items_.push_back(make());
    return items_[used_++];
  }
  Item& add() {
    return add([] { return Item(); });
  }

  [[nodiscard]] std::size_t size() const { return used_; }
  [[nodiscard]] Item& operator[](std::size_t index) { return items_[index]; }
  [[nodiscard]] const Item& operator[](std::size_t index) const { return items_[index]; }
  [[nodiscard]] auto begin() { return items_.begin(); }
  [[nodiscard]] auto end() { return items_.begin() + static_cast<std::ptrdiff_t>(used_); }
  [[nodiscard]] auto begin() const { return items_.begin(); }
  [[nodiscard]] auto end() const { return items_.begin() + static_cast<std::ptrdiff_t>(used_); }

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = items_.capacity() * sizeof(Item);
    for (const Item& item : items_) total += item.bytes();
    return total;
  }

 private:
  void release() {
    if (items_.size() > most_.most())
      items_.erase(items_.begin() + static_cast<std::ptrdiff_t>(most_.most()), items_.end());
    if (items_.empty()) std::vector<Item>().swap(items_);
  }

  std::vector<Item> items_;
  std::size_t used_ = 0;
  HighWater most_;
};

}  // namespace sweepgrid
