#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

/// The interval list of one axis as a linked list of bounded segments with a directory for binary search (section
/// 3.2.2, the paper's chunks). Knows endpoints and segments only; what a cut or a merge means for checkpoint sets is
/// its owner's business. No segment is empty, but the only one of an empty list, and one that is about to be merged.
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
  [[nodiscard]] End last(SegmentId segment) const { return ends(segment)[count(segment) - 1]; }
  [[nodiscard]] std::uint32_t count(SegmentId segment) const { return links_[segment].count; }
  [[nodiscard]] SegmentId previous(SegmentId segment) const { return links_[segment].previous; }
  [[nodiscard]] SegmentId next(SegmentId segment) const { return links_[segment].next; }
  [[nodiscard]] SegmentId front() const { return directory_.empty() ? kNone : directory_.front(); }
  [[nodiscard]] std::uint32_t capacity() const { return capacity_; }

  /// Segments have ids below this.
  [[nodiscard]] std::size_t id_bound() const { return links_.size(); }

  /// The segment that `end` belongs to: the last that begins before it, else the first. Creates the first segment of an
  /// empty list. Precondition: sorted. O(log segments).
  SegmentId segment_for(End end) {
    if (directory_.empty()) directory_.push_back(allocate());
    return directory_[directory_index(end)];
  }

  /// Comparisons that segment_for() takes.
  [[nodiscard]] std::uint32_t search_steps() const {
    return static_cast<std::uint32_t>(std::bit_width(directory_.size()));
  }

  /// Whether `end` lies before the segments that follow `segment`.
  [[nodiscard]] bool before_next(SegmentId segment, End end) const {
    return next(segment) == kNone || end < ends(next(segment))[0];
  }

  /// Offset of the first endpoint in a segment that is not less than `end`. Precondition: sorted. O(capacity).
  [[nodiscard]] std::uint32_t offset(SegmentId segment, End end) const {
    // Counted, not searched: the reads do not wait for each other, and there is no branch to be mispredicted.
    std::uint32_t less = 0;
    for (const End other : std::span(ends(segment), count(segment))) less += std::uint32_t{other < end};
    return less;
  }

  /// Puts sorted endpoints in order into a segment that has room for them.
  void insert(SegmentId segment, std::span<const End> added);

  /// Takes sorted endpoints out of their segment, which may be left empty.
  void erase(SegmentId segment, std::span<const End> gone);

  /// Spreads sorted endpoints evenly over a segment and `pieces` - 1 new ones after it; what it held is lost. Returns
  /// the last piece.
  SegmentId spread(SegmentId segment, std::span<const End> sorted, std::size_t pieces);

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
  [[nodiscard]] std::size_t directory_index(End end) const;

  std::uint32_t capacity_;
  std::vector<End> pool_;  // segment s owns [s * capacity, (s + 1) * capacity)
  std::vector<Link> links_;
  std::vector<SegmentId> directory_;  // in list order
  std::vector<SegmentId> free_;
};

template <class Scalar>
void SegmentedList<Scalar>::insert(SegmentId segment, std::span<const End> added) {
  End* const first = ends(segment);
  std::size_t kept = count(segment);
  std::size_t left = added.size();
  links_[segment].count += static_cast<std::uint32_t>(left);
  while (left > 0) {
    const bool move = kept > 0 && added[left - 1] < first[kept - 1];
    const std::size_t to = kept + left - 1;
    first[to] = move ? first[--kept] : added[--left];
  }
}

template <class Scalar>
void SegmentedList<Scalar>::erase(SegmentId segment, std::span<const End> gone) {
  End* const first = ends(segment);
  std::uint32_t to = offset(segment, gone.front());
  for (std::uint32_t from = to; from < count(segment); ++from) {
    const bool goes = !gone.empty() && first[from] == gone.front();
    if (!goes) first[to++] = first[from];
    gone = gone.subspan(goes ? 1 : 0);
  }
  links_[segment].count = to;
}

template <class Scalar>
auto SegmentedList<Scalar>::spread(SegmentId segment, std::span<const End> sorted, std::size_t pieces) -> SegmentId {
  const std::size_t index = directory_index(ends(segment)[0]);
  directory_.insert(directory_.begin() + static_cast<std::ptrdiff_t>(index) + 1, pieces - 1, kNone);
  const SegmentId after = next(segment);
  SegmentId last = segment;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const SegmentId to = piece == 0 ? segment : allocate();
    const std::size_t begin = sorted.size() * piece / pieces;
    const auto part = sorted.subspan(begin, sorted.size() * (piece + 1) / pieces - begin);
    std::copy(part.begin(), part.end(), ends(to));
    links_[to].count = static_cast<std::uint32_t>(part.size());
    if (piece > 0) {
      links_[to].previous = last;
      links_[last].next = to;
      directory_[index + piece] = to;
    }
    last = to;
  }
  links_[last].next = after;
  if (after != kNone) links_[after].previous = last;
  return last;
}

template <class Scalar>
void SegmentedList<Scalar>::merge_next(SegmentId segment) {
  const SegmentId gone = next(segment);
  // One of the two may be empty; what it held last still tells where it is.
  const std::size_t index = directory_index(ends(gone)[0]);
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

// By a key search, so that links need no index that every split would have to renumber.
template <class Scalar>
std::size_t SegmentedList<Scalar>::directory_index(End end) const {
  std::size_t base = 0;
  for (std::size_t rest = directory_.size() - 1; rest > 0;) {
    const std::size_t half = (rest + 1) / 2;
    base += half * std::size_t{ends(directory_[base + half])[0] <= end};
    rest -= half;
  }
  return base;
}

}  // namespace sweepgrid
