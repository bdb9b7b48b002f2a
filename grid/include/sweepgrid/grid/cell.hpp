#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/grid/kind_choice.hpp>
#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/row_cell.hpp>

namespace sweepgrid {

/// One cell of a grid: its place, and its kind. Rows, the kind of nearly all cells, lie in the cell itself.
template <class Scalar, int Dim>
class Cell {
 public:
  using Kind = SweepAndPrune<Scalar, Dim>;

  Cell(std::uint64_t code, const CellOptions& options) : code_(code) {
    if (options.kind != CellKind::kRows && options.kind != CellKind::kAuto) {
      other_ = std::make_unique<Other>();
      other_->kind = options.kind;
      other_->cell = make_cell<Scalar, Dim>(options);
    }
  }

  [[nodiscard]] std::uint64_t code() const { return code_; }
  [[nodiscard]] Kind& kind() { return has_rows() ? static_cast<Kind&>(rows_) : *other_->cell; }
  [[nodiscard]] const Kind& kind() const { return has_rows() ? static_cast<const Kind&>(rows_) : *other_->cell; }
  [[nodiscard]] CellKind kind_name() const { return other_ ? other_->kind : CellKind::kRows; }
  [[nodiscard]] std::size_t size() const { return has_rows() ? rows_.size() : other_->cell->size(); }
  [[nodiscard]] bool has_rows() const { return !other_ || !other_->cell; }

  void drain(std::span<const CellOp<Scalar, Dim>> ops, DeltaList& deltas, SapCounters& counters) {
    if (has_rows()) return rows_.drain(ops, deltas, counters);  // not virtual
    other_->cell->drain(ops, deltas, counters);
  }

  /// Takes residents in without a word about pairs. Precondition: it has none.
  void fill(std::span<const CellOp<Scalar, Dim>> ops, SapCounters& counters) {
    if (has_rows()) return rows_.refill(ops);
    other_->cell->transfer(ops, counters);
  }

  /// Kind::visit(). `residents`: memory for them.
  void visit(std::span<const typename Kind::Visit> visits, std::vector<typename Kind::Resident>& residents,
             DeltaList& deltas, SapCounters& counters) const {
    if (has_rows()) return rows_.visit(visits, deltas, counters);
    residents.clear();
    if (!visits.empty()) other_->cell->append_residents(residents);
    Kind::visit(residents, visits, deltas, counters);
  }

  /// Precondition: has_rows().
  [[nodiscard]] RowCell<Scalar, Dim>& rows() { return rows_; }

  /// To be told after each drain of a cell whose kind is chosen: what it added to the counters.
  void choose_kind(std::size_t ops, const SapCounters& work, const CellOptions& options, SapCounters& counters) {
    if (!other_) {
      if (size() < KindChoice::kManyObjects) return;
      other_ = std::make_unique<Other>();
    }
    const CellKind wanted = other_->choice.observe(other_->kind, size(), ops, work);
    if (wanted == other_->kind) return;
    become(wanted, options);
    ++counters.kinds_changed;
  }

  [[gnu::always_inline]] void prefetch() const { has_rows() ? rows_.prefetch() : other_->cell->prefetch(); }

  [[nodiscard]] std::size_t bytes() const {
    return rows_.bytes() + (other_ ? sizeof(Other) + (other_->cell ? other_->cell->bytes() : 0) : 0);
  }

 private:
  struct Other {
    KindChoice choice;
    CellKind kind = CellKind::kRows;
    std::unique_ptr<Kind> cell;  // null: the rows of the cell itself
  };

  void become(CellKind wanted, CellOptions options) {
    std::vector<typename Kind::Resident> residents;
    kind().append_residents(residents);
    std::vector<CellOp<Scalar, Dim>> ops;
    ops.reserve(residents.size());
    for (const auto& resident : residents) ops.push_back({resident.object, OpKind::kInsert, resident.box});
    options.kind = wanted;
    SapCounters unused;
    if (wanted == CellKind::kRows) {
      rows_.transfer(ops, unused);
      other_->cell.reset();
    } else {
      auto cell = make_cell<Scalar, Dim>(options);
      cell->transfer(ops, unused);
      other_->cell = std::move(cell);
      rows_ = RowCell<Scalar, Dim>();
    }
    other_->kind = wanted;
  }

  std::uint64_t code_;
  RowCell<Scalar, Dim> rows_;
  std::unique_ptr<Other> other_;  // null: rows_ it is, and nobody asks whether it should be
};

}  // namespace sweepgrid
