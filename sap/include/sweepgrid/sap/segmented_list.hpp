#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

/// The interval list of one axis as a linked list of bounded segments with a directory for binary search (section
/// 3.2.2, the paper's chunks). Knows endpoints and segments only; what a split or merge means for checkpoint sets is
/// its owner's business.
template <class Scalar>
class SegmentedList {
 public:
  using End = Endpoint<Scalar>;
  using SegmentId = std::uint32_t;
  static constexpr SegmentId kNone = 0xffffffffU;

  /// A place in the list. Offsets count from the segment's start.
  struct Place {
    SegmentId segment;
    std::uint32_t offset;
  };

  explicit SegmentedList(int capacity) : capacity_(static_cast<std::uint32_t>(capacity)) {}

  [[nodiscard]] End& at(Place place) { return ends(place.segment)[place.offset]; }
  [[nodiscard]] End* ends(SegmentId segment) { return pool_.data() + std::size_t{segment} * capacity_; }
  [[nodiscard]] const End* ends(SegmentId segment) const { return pool_.data() + std::size_t{segment} * capacity_; }
  [[nodiscard]] std::uint32_t count(SegmentId segment) const { return links_[segment].count; }
  [[nodiscard]] SegmentId previous(SegmentId segment) const { return links_[segment].previous; }
  [[nodiscard]] SegmentId next(SegmentId segment) const { return links_[segment].next; }
  [[nodiscard]] SegmentId front() const { return directory_.empty() ? kNone : directory_.front(); }
  [[nodiscard]] bool full(SegmentId segment) const { return count(segment) == capacity_; }
  [[nodiscard]] std::uint32_t capacity() const { return capacity_; }

  /// Segments have ids below this.
  [[nodiscard]] std::size_t id_bound() const { return links_.size(); }

  /// The segment that `end` belongs to: the earliest with a greater endpoint, else the last. Creates the first segment
  /// of an empty list. Precondition: sorted. O(log segments).
  SegmentId segment_for(End end);

  /// Offset of `end` in its segment. Precondition: it is there.
  [[nodiscard]] std::uint32_t offset(SegmentId segment, End end) const {
    const End* first = ends(segment);
    return static_cast<std::uint32_t>(std::find(first, first + count(segment), end) - first);
  }

  /// Puts `end` in order into a segment that is not full.
  void insert(SegmentId segment, End end);

  /// Takes `end` out of its segment, which may be left empty.
  void erase(SegmentId segment, End end);

  /// Moves the upper half of a segment to a new one after it, and returns that. Precondition: sorted.
  SegmentId split(SegmentId segment);

  /// Appends the endpoints of the segment after `segment` to it and drops that. Precondition: they fit.
  void merge_next(SegmentId segment);

  void prefetch() const {
    sweepgrid::prefetch(pool_.data(), pool_.size() * sizeof(End));
    sweepgrid::prefetch(links_.data(), links_.size() * sizeof(Link));
  }

  [[nodiscard]] const std::vector<SegmentId>& directory() const { return directory_; }

  [[nodiscard]] std::size_t bytes() const {
    return pool_.capacity() * sizeof(End) + links_.capacity() * sizeof(Link) +
           (directory_.capacity() + free_.capacity()) * sizeof(SegmentId);
  }

 private:
  struct Link {
    std::uint32_t count = 0;
    SegmentId previous = kNone;
    SegmentId next = kNone;
  };

  SegmentId allocate();
  [[nodiscard]] std::size_t directory_index(SegmentId segment) const;

  std::uint32_t capacity_;
  std::vector<End> pool_;  // segment s owns [s * capacity, (s + 1) * capacity)
  std::vector<Link> links_;
  std::vector<SegmentId> directory_;  // in list order
  std::vector<SegmentId> free_;
};

template <class Scalar>
auto SegmentedList<Scalar>::segment_for(End end) -> SegmentId {
  if (directory_.empty()) directory_.push_back(allocate());
  const auto found = std::partition_point(directory_.begin(), directory_.end() - 1,
                                          [&](SegmentId segment) { return ends(segment)[count(segment) - 1] < end; });
  return *found;
}

template <class Scalar>
void SegmentedList<Scalar>::insert(SegmentId segment, End end) {
  End* const first = ends(segment);
  std::uint32_t offset = links_[segment].count++;
  for (; offset > 0 && end < first[offset - 1]; --offset) first[offset] = first[offset - 1];
  first[offset] = end;
}

template <class Scalar>
void SegmentedList<Scalar>::erase(SegmentId segment, End end) {
  End* const first = ends(segment);
  std::copy(first + offset(segment, end) + 1, first + count(segment), first + offset(segment, end));
  --links_[segment].count;
}

template <class Scalar>
auto SegmentedList<Scalar>::split(SegmentId segment) -> SegmentId {
  const std::size_t index = directory_index(segment);
  const SegmentId upper = allocate();
  const std::uint32_t kept = count(segment) / 2;
  std::copy(ends(segment) + kept, ends(segment) + count(segment), ends(upper));
  links_[upper] = {count(segment) - kept, segment, next(segment)};
  if (next(segment) != kNone) links_[next(segment)].previous = upper;
  links_[segment].next = upper;
  links_[segment].count = kept;
  directory_.insert(directory_.begin() + static_cast<std::ptrdiff_t>(index) + 1, upper);
  return upper;
}

template <class Scalar>
void SegmentedList<Scalar>::merge_next(SegmentId segment) {
  const SegmentId gone = next(segment);
  // Before the counts change: an empty segment has no endpoint to be found by, but its neighbour in the list does.
  const std::size_t index = count(segment) > 0 ? directory_index(segment) + 1 : directory_index(gone);
  std::copy(ends(gone), ends(gone) + count(gone), ends(segment) + count(segment));
  links_[segment].count += count(gone);
  links_[segment].next = next(gone);
  if (next(gone) != kNone) links_[next(gone)].previous = segment;
  directory_.erase(directory_.begin() + static_cast<std::ptrdiff_t>(index));
  free_.push_back(gone);
}

template <class Scalar>
auto SegmentedList<Scalar>::allocate() -> SegmentId {
  if (!free_.empty()) {
    const SegmentId segment = free_.back();
    free_.pop_back();
    links_[segment] = Link{};
    return segment;
  }
  links_.emplace_back();
  pool_.resize(links_.size() * capacity_);
  return static_cast<SegmentId>(links_.size() - 1);
}

// By a key search, so that links need no index that every split would have to renumber. One segment may be empty, just
// before it is merged: it lies before the key when the segment after it does, or is the one sought.
template <class Scalar>
std::size_t SegmentedList<Scalar>::directory_index(SegmentId segment) const {
  const End key = ends(segment)[0];
  const auto found = std::partition_point(directory_.begin(), directory_.end(), [&](SegmentId other) {
    return count(other) > 0 ? ends(other)[count(other) - 1] < key : next(other) != kNone && ends(next(other))[0] <= key;
  });
  return static_cast<std::size_t>(found - directory_.begin());
}

}  // namespace sweepgrid
