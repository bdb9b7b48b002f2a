#pragma once

#include <cstddef>
#include <span>

#include <sweepgrid/sap/cell_op.hpp>

namespace sweepgrid {

/// An array of CellOps or Visits as code sees it that knows the width of their ordered bits, but not their scalar.
/// `View`, which says where the members lie, is OpView or VisitView.
template <class View>
class RowViews {
 public:
  template <class Item>
  explicit RowViews(std::span<const Item> items)
      : data_(reinterpret_cast<const std::byte*>(items.data())), size_(items.size()) {
    static_assert(View::template kFits<Item>);
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] View operator[](std::size_t index) const { return View(data_ + index * View::kSize); }

 private:
  const std::byte* data_;
  std::size_t size_;
};

/// A CellOp. A box is Dim mins, then Dim maxes.
template <class Bits, int Dim>
class OpView {
 public:
  static constexpr std::size_t kBox = 8;
  static constexpr std::size_t kSize = kBox + 2 * Dim * sizeof(Bits);
  template <class Op>
  static constexpr bool kFits = offsetof(Op, object) == 0 && offsetof(Op, kind) == sizeof(ObjectId) &&
                                offsetof(Op, box) == kBox && sizeof(Op) == kSize;

  explicit OpView(const std::byte* data) : data_(data) {}
  [[nodiscard]] ObjectId object() const { return *reinterpret_cast<const ObjectId*>(data_); }
  [[nodiscard]] OpKind kind() const { return *reinterpret_cast<const OpKind*>(data_ + sizeof(ObjectId)); }
  [[nodiscard]] const Bits* box() const { return reinterpret_cast<const Bits*>(data_ + kBox); }

 private:
  const std::byte* data_;
};

/// A SweepAndPrune::Visit.
template <class Bits, int Dim>
class VisitView {
 public:
  static constexpr std::size_t kWas = 4;
  static constexpr std::size_t kIs = 5;
  static constexpr std::size_t kBefore = 8;
  static constexpr std::size_t kAfter = kBefore + 2 * Dim * sizeof(Bits);
  static constexpr std::size_t kSize = kAfter + 2 * Dim * sizeof(Bits);
  template <class Visit>
  static constexpr bool kFits = offsetof(Visit, object) == 0 &&
                                offsetof(Visit, was) == kWas&& offsetof(Visit, is) == kIs&& offsetof(Visit, before) ==
                                    kBefore&& offsetof(Visit, after) == kAfter
                                && sizeof(Visit) == kSize;

  explicit VisitView(const std::byte* data) : data_(data) {}
  [[nodiscard]] ObjectId object() const { return *reinterpret_cast<const ObjectId*>(data_); }
  [[nodiscard]] bool was() const { return *reinterpret_cast<const bool*>(data_ + kWas); }
  [[nodiscard]] bool is() const { return *reinterpret_cast<const bool*>(data_ + kIs); }
  [[nodiscard]] const Bits* before() const { return reinterpret_cast<const Bits*>(data_ + kBefore); }
  [[nodiscard]] const Bits* after() const { return reinterpret_cast<const Bits*>(data_ + kAfter); }

 private:
  const std::byte* data_;
};

template <class Bits, int Dim>
using OpViews = RowViews<OpView<Bits, Dim>>;

template <class Bits, int Dim>
using VisitViews = RowViews<VisitView<Bits, Dim>>;

}  // namespace sweepgrid
