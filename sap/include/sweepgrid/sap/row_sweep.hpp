#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// The type in which a sweep compares coordinates: the smaller of float and double that holds every value of Scalar; of
/// 64-bit integers, which neither does, double. To round them keeps their order, so overlaps stay overlaps, and who
/// sweeps has to look again: see kSweepsRounded.
template <class Scalar>
using SweepValue =
    std::conditional_t<std::numeric_limits<Scalar>::digits <= std::numeric_limits<float>::digits, float, double>;

template <class Scalar>
inline constexpr bool kSweepsRounded =
    std::numeric_limits<Scalar>::digits > std::numeric_limits<SweepValue<Scalar>>::digits;

/// How space is cut for a sweep: into rows along one axis, which are the cells of a grid over the others, and each row
/// into bins. A coordinate's cell never falls as the coordinate grows: trunc(coordinate * scale + offset), without
/// rounding product and sum together, at least 0 and at most `last`. So boxes that overlap share a row, and a bin in
/// it.
template <class Value, int Dim>
struct RowCut {
  std::array<Value, static_cast<std::size_t>(Dim)> scale;
  std::array<Value, static_cast<std::size_t>(Dim)> offset;
  std::array<Value, static_cast<std::size_t>(Dim)> last;
  /// Rows between two that are neighbours on an axis; any number for the axis along which they lie.
  std::array<std::uint32_t, static_cast<std::size_t>(Dim)> stride;
  int along;
};

/// What a row needs to know of a member beside its box, in the lowest bits of its reach.
namespace row_marks {
inline constexpr int kBits = 6;
/// For the use of who sweeps.
inline constexpr std::uint32_t kFree = 7;
/// The member is in an earlier row as well, on the first row axis, on the second, on the third.
inline constexpr std::uint32_t kFirstEarlier = 8;
inline constexpr std::uint32_t kEarlier = 8 + 16 + 32;
}  // namespace row_marks

/// The box of nobody, which meets nothing.
template <class Value>
inline constexpr std::array<Value, 16> kBoxOfNobody = [] {
  std::array<Value, 16> box{};
  box.fill(std::numeric_limits<Value>::quiet_NaN());
  return box;
}();

/// An object, or one side of it, in a row.
template <class Value>
struct RowMember {
  const Value* box;
  std::uint32_t object;
  std::uint32_t reach;  // the last bin, and below it bits of row_marks
};

/// Entries of objects in rows, list by list.
template <std::size_t kCapacity>
struct RowEntries {
  alignas(64) std::uint32_t row[kCapacity];
  alignas(64) std::uint32_t bin[kCapacity];
  alignas(64) std::uint32_t object[kCapacity];
  alignas(64) std::uint32_t reach[kCapacity];  // the last bin, and below it bits of row_marks
  std::size_t count = 0;
};

/// What a sweep has found: an earlier member of the row, and those among the 16 members from `first` on whose overlap
/// with it has changed, or that overlap now, one bit each.
struct SweepHit {
  std::uint32_t member;
  std::uint32_t first;
  std::uint16_t changed;
  std::uint16_t overlap;
};

/// Takes hits as a sweep finds them, many at a time.
class SweepSink {
 public:
  SweepSink() = default;
  virtual ~SweepSink() = default;
  SweepSink(const SweepSink&) = delete;
  SweepSink& operator=(const SweepSink&) = delete;
  virtual void take(std::span<const SweepHit> hits) = 0;
};

/// Memory that sweeps use one after another. Not thread-safe: one for each worker.
class SweepScratch {
 public:
  /// Ends a step: memory beyond what HighWater allows goes back.
  void note_step() {
    water_.note(used_);
    release();
  }
  /// As note_step() for so many steps in which nothing was swept.
  void pass(std::size_t steps) {
    used_ = 0;
    water_.pass(steps);
    release();
  }
  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const { return size_; }

  /// At least so many bytes, aligned to 64, that hold nothing yet.
  [[nodiscard]] std::byte* get(std::size_t bytes) {
    used_ = used_ < bytes ? bytes : used_;
    if (bytes > size_) {
      data_.reset();
      size_ = 0;
      data_.reset(static_cast<std::byte*>(::operator new(bytes + bytes / 4, kAlignment)));
      size_ = bytes + bytes / 4;
    }
    return data_.get();
  }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(std::byte* data) const { ::operator delete(data, kAlignment); }
  };

  void release() {
    used_ = 0;
    if (size_ <= water_.allowed()) return;
    data_.reset();
    size_ = 0;
  }

  std::unique_ptr<std::byte, Free> data_;
  std::size_t size_ = 0;
  std::size_t used_ = 0;
  HighWater water_;
};

/// One row of a sweep from scratch, with vector instructions chosen by what the machine has.
template <class Value, int Dim>
struct RowSweep {
  /// A box is so many values: the mins and the maxes after the step, then those before it. A side that there is not is
  /// NaN in its first value at least.
  static constexpr std::size_t kValues = 4 * Dim;
  /// By how many a list must be longer than it says.
  static constexpr std::size_t kPadding = 16;
  /// Others do not exist.
  static constexpr bool kCompiled =
      (std::is_same_v<Value, float> || std::is_same_v<Value, double>)&&Dim >= 1 && Dim <= 4;

  using Cut = RowCut<Value, Dim>;
  /// Objects that are placed at once.
  static constexpr std::size_t kPlaced = 256;
  static constexpr std::size_t kCorners = std::size_t{1} << (Dim - 1);
  using Entries = RowEntries<kPlaced * kCorners + 16>;
  /// An object that is in more bins than so many is left out by place().
  static constexpr std::int32_t kFewBins = 24;

  /// Lists in which rows and bins the `count` objects are, at most kPlaced, by what holds both sides of their boxes.
  /// Who is in more than two rows of an axis, or many bins, is left out: their places are written to `far`, which has
  /// room for `count`. Returns how many there are. `boxes` and `objects` are longer by kPadding; what stands there is
  /// written.
  static std::size_t place(const Value** boxes, std::uint32_t* objects, std::uint32_t count, const Cut& cut,
                           Entries& entries, std::uint32_t* far);

  using Member = RowMember<Value>;

  /// Compares every member of a row with those behind it that are in a bin which it reaches, and tells the sink whom it
  /// meets otherwise after the step than before; with `all`, whom it meets before or after. Returns how many were
  /// compared with another, whatever the vectors are.
  ///
  /// `members`: in the order of bins, `count` of them, and kPadding more of any kind. `bins`: for each bin of the row,
  /// how many members before the row and in it have this bin or an earlier one; `first`: how many are before the row.
  static std::uint64_t sweep(const Member* members, std::uint32_t count, const std::uint32_t* bins, std::uint32_t first,
                             bool all, SweepScratch& scratch, SweepSink& sink);
};

}  // namespace sweepgrid
