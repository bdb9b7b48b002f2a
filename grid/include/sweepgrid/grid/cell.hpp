#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
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
  [[nodiscard]] Kind& kind() { return has_rows() ? static_cast<Kind&>(rows_) : *other_; }
  [[nodiscard]] const Kind& kind() const { return has_rows() ? static_cast<const Kind&>(rows_) : *other_; }
  [[nodiscard]] std::size_t size() const { return has_rows() ? rows_.size() : other_->size(); }
  [[nodiscard]] bool has_rows() const { return !other_; }

  void drain(std::span<const CellOp<Scalar, Dim>> ops, DeltaList& deltas, SapCounters& counters) {
    if (has_rows()) return rows_.drain(ops, deltas, counters);  // not virtual
    other_->drain(ops, deltas, counters);
  }

  /// Takes residents in without a word about pairs. Precondition: it has none.
  void fill(std::span<const CellOp<Scalar, Dim>> ops, SapCounters& counters) {
    if (has_rows()) return rows_.refill(ops);
    other_->transfer(ops, counters);
  }

  /// Kind::visit(). `residents`: memory for them.
  void visit(std::span<const typename Kind::Visit> visits, std::vector<typename Kind::Resident>& residents,
             DeltaList& deltas, SapCounters& counters) const {
    if (has_rows()) return rows_.visit(visits, deltas, counters);
    residents.clear();
    if (!visits.empty()) other_->append_residents(residents);
    Kind::visit(residents, visits, deltas, counters);
  }

  /// Precondition: has_rows().
  [[nodiscard]] RowCell<Scalar, Dim>& rows() { return rows_; }

  [[gnu::always_inline]] void prefetch() const { has_rows() ? rows_.prefetch() : other_->prefetch(); }

  [[nodiscard]] std::size_t bytes() const { return rows_.bytes() + (other_ ? other_->bytes() : 0); }

 private:
  std::uint64_t code_;
  RowCell<Scalar, Dim> rows_;
  std::unique_ptr<Kind> other_;  // null: rows_ it is
};

}  // namespace sweepgrid
