#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/row_cell.hpp>

namespace sweepgrid {

/// One cell of a grid: its place, and its kind. Rows, the kind of nearly all cells, lie in the cell itself.
template <class Scalar, int Dim>
class Cell {
 public:
  using Kind = SweepAndPrune<Scalar, Dim>;

  Cell(std::uint64_t code, const CellOptions& options) : code_(code) {
    if (options.kind != CellKind::kRows) other_ = make_cell<Scalar, Dim>(options);
  }

  [[nodiscard]] std::uint64_t code() const { return code_; }
  [[nodiscard]] Kind& kind() { return other_ ? *other_ : static_cast<Kind&>(rows_); }
  [[nodiscard]] const Kind& kind() const { return other_ ? *other_ : static_cast<const Kind&>(rows_); }
  [[nodiscard]] std::size_t size() const { return other_ ? other_->size() : rows_.size(); }
  [[nodiscard]] bool has_rows() const { return other_ == nullptr; }

  void drain(std::span<const CellOp<Scalar, Dim>> ops, std::vector<OverlapDelta>& deltas, SapCounters& counters) {
    if (!other_) return rows_.drain(ops, deltas, counters);  // not virtual
    other_->drain(ops, deltas, counters);
  }

  /// Ids of the residents of a cell of rows, by place.
  [[nodiscard]] std::span<const ObjectId> row_ids() const { return rows_.ids(); }

  void prefetch() const { other_ ? other_->prefetch() : rows_.prefetch(); }

  [[nodiscard]] std::size_t bytes() const { return other_ ? other_->bytes() : rows_.bytes(); }

 private:
  std::uint64_t code_;
  RowCell<Scalar, Dim> rows_;
  std::unique_ptr<Kind> other_;  // null: rows_ it is
};

}  // namespace sweepgrid
