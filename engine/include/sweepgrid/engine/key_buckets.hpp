#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>

#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Objects by a tag, a well mixed hash of their key: open addressing with linear probing. The tag lies beside the id,
/// so that keys are looked at only where the tags are the same. A tag's first bucket is its share of the table: any
/// number of buckets will do, and as they are in the order of tags, another number is one pass.
class KeyBuckets {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const { return count_ * sizeof(Bucket); }

  /// `is_it(object)` is asked of objects with the tag. kNoObject when there is none.
  template <class IsIt>
  [[nodiscard]] ObjectId find(std::uint32_t tag, IsIt&& is_it) const {
    return size_ == 0 ? kNoObject : buckets_[place(tag, is_it)].object;
  }

  /// Makes room for `more` objects. O(size()), amortised O(more).
  void reserve(std::size_t more) {
    const std::size_t wanted = size_ + more;
    if (4 * wanted <= 3 * count_) return;
    const std::size_t count = size_ == 0 ? wanted + wanted / 2 + 8 : 2 * wanted;
    resize(std::unique_ptr<Bucket[]>(new Bucket[count]), count);
  }

  /// Calls `make` for the new object unless there is one already; returns whether it was called.
  /// Precondition: reserve().
  template <class IsIt, class Make>
  bool insert(std::uint32_t tag, IsIt&& is_it, Make&& make) {
    Bucket& bucket = buckets_[place(tag, is_it)];
    if (bucket.object != kNoObject) return false;
    bucket = {tag, make()};
    ++size_;
    return true;
  }

  /// Precondition: it is in.
  void erase(std::uint32_t tag, ObjectId object) {
    std::size_t hole = place(tag, [object](ObjectId other) { return other == object; });
    for (std::size_t i = next(hole); buckets_[i].object != kNoObject; i = next(i)) {
      if (distance(first(buckets_[i].tag), i) < distance(hole, i)) continue;
      buckets_[hole] = buckets_[i];
      hole = i;
    }
    buckets_[hole].object = kNoObject;
    --size_;
  }

  /// Gives memory back when few objects are left. Amortised O(1).
  void shrink() noexcept {
    if (8 * size_ + 64 > count_) return;
    const std::size_t count = 2 * size_ + 8;
    // A table that is larger than need be is no reason to fail.
    std::unique_ptr<Bucket[]> buckets(new (std::nothrow) Bucket[count]);
    if (buckets != nullptr) resize(std::move(buckets), count);
  }

 private:
  struct Bucket {
    std::uint32_t tag = 0;
    ObjectId object = kNoObject;
  };

  [[nodiscard]] std::size_t first(std::uint32_t tag) const {
    return static_cast<std::size_t>(std::uint64_t{tag} * count_ >> 32);
  }
  [[nodiscard]] std::size_t next(std::size_t i) const { return i + 1 == count_ ? 0 : i + 1; }
  [[nodiscard]] std::size_t distance(std::size_t from, std::size_t to) const {
    return to >= from ? to - from : to + count_ - from;
  }

  // Bucket of the object, or the free one where it belongs.
  template <class IsIt>
  [[nodiscard]] std::size_t place(std::uint32_t tag, IsIt&& is_it) const {
    std::size_t i = first(tag);
    while (buckets_[i].object != kNoObject && !(buckets_[i].tag == tag && is_it(buckets_[i].object))) i = next(i);
    return i;
  }

  void resize(std::unique_ptr<Bucket[]> buckets, std::size_t count) {
    buckets.swap(buckets_);
    std::swap(count, count_);
    for (std::size_t i = 0; i < count; ++i) {
      if (buckets[i].object == kNoObject) continue;
      buckets_[place(buckets[i].tag, [](ObjectId) { return false; })] = buckets[i];
    }
  }

  std::unique_ptr<Bucket[]> buckets_;
  std::size_t count_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sweepgrid
