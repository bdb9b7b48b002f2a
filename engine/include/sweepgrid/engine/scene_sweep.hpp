#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_items.hpp>
#include <sweepgrid/engine/sweep_tasks.hpp>
#include <sweepgrid/grid/row_bins.hpp>
#include <sweepgrid/sap/row_sweep.hpp>
#include <sweepgrid/sap/step_budget.hpp>

namespace sweepgrid {

/// Steps that sweep all objects from scratch, and keep nothing but their boxes: the old and the new box of every object
/// are put into rows, and each row is swept once with the boxes after the step and once with those before it. What
/// differs is the events.
///
/// A step is plan_bin(), bin() of every block of objects, plan_sweep(), sweep() of every part of the rows, and then
/// commit(), or nothing: until then ops stay queued. Blocks may be binned at once, and parts be swept at once.
template <class Scalar, int Dim>
class SceneSweep {
 public:
  using Objects = ObjectTable<Scalar, Dim>;
  using BoxType = Box<Scalar, Dim>;
  using Value = SweepValue<Scalar>;
  /// Else none of the calls may be made.
  static constexpr bool kPossible = RowSweep<Value, Dim>::kCompiled;

  /// `event_bytes`: what the lists of an event take in all. All references must outlive it.
  SceneSweep(Objects& objects, StepBudget& budget, std::size_t event_bytes)
      : objects_(objects), budget_(budget), event_bytes_(event_bytes) {}

  /// What an entry in a row is charged to the budget.
  static constexpr std::uint64_t kEntryBytes = 16;

  // `workers`: how many there are; `worker`: the number of the one that calls.
  void plan_bin(std::size_t workers, std::vector<std::uint64_t>& costs);
  void bin(std::size_t block, std::size_t worker);
  void plan_sweep(std::size_t worker, std::vector<std::uint64_t>& costs);
  void sweep(std::size_t part, std::size_t worker);

  /// To be called before commit(), which then cannot fail.
  void reserve();
  /// Ends the step. Returns what was counted, but for events.
  StepCounters commit() noexcept;
  /// Forgets what an unfinished step has found.
  void cancel() noexcept;

  /// There are no events.
  void rest() { sweeps_.restart(); }
  /// Ends so many steps in which nothing was swept.
  void pass(std::size_t steps);

  /// The events that the latest step found, in lists that may be read until the next. A pair is in at most one of them.
  [[nodiscard]] std::size_t lists() const { return sweeps_.size(); }
  [[nodiscard]] std::span<const PairKey> begins(std::size_t list) const { return sweeps_[list].begins.items; }
  [[nodiscard]] std::span<const PairKey> ends(std::size_t list) const { return sweeps_[list].ends.items; }

  /// Calls `visit(row, marks)` for every row in which a box is as rows are fitted now: see RowBins::for_each_row().
  template <class Visit>
  void for_each_row(const BoxType& box, Visit&& visit) const {
    const auto values = values_of(box);
    rows_.for_each_row(rows_.span(values.data(), values.data()), visit);
  }

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const { return bins_.bytes() + sweeps_.bytes() + scratch_.bytes(); }

 private:
  using Record = typename Objects::Record;
  using Bins = RowBins<Value, Dim>;
  using Bin = sweep_tasks::Bin<Value>;
  using Sweep = sweep_tasks::Sweep;
  using Scratch = sweep_tasks::Scratch<Value, Dim>;
  using Member = RowMember<Value>;
  class Binner;
  class Sink;
  /// Whether a record holds an object's boxes as a row wants them.
  static constexpr std::size_t kValues = RowSweep<Value, Dim>::kValues;
  static constexpr bool kDirect = std::is_same_v<Scalar, Value>;
  static constexpr std::size_t kOld = 2 * Dim;

  /// Of a step.
  enum class Side { kBefore, kAfter };
  static constexpr std::size_t kEndless = std::numeric_limits<std::size_t>::max();

  [[nodiscard]] static std::array<Value, 2 * Dim> values_of(const BoxType& box);
  template <class Use>
  void with_box(Side side, ObjectId object, Use&& use) const;
  [[nodiscard]] Bins fitted(Side side) const;
  void fit();
  [[nodiscard]] bool crowded(Side side) const;
  void part_sides();
  void start_bins(std::size_t workers, std::vector<std::uint64_t>& costs);
  void bin_anew(std::size_t worker);
  [[nodiscard]] const Bins& rows_of(std::size_t part) const { return part < parts_after_ ? rows_ : rows_before_; }
  [[nodiscard]] std::size_t sort(std::size_t part, Scratch& scratch) const;
  struct WasIs {
    bool was;
    bool is;
  };
  [[nodiscard]] WasIs overlaps(ObjectId a, ObjectId b) const;
  [[nodiscard]] static const Value* values(const Record& record) {
    static_assert(offsetof(Record, before) == sizeof(BoxType) && sizeof(BoxType) == 2 * Dim * sizeof(Scalar));
    return reinterpret_cast<const Value*>(&record);
  }

  Objects& objects_;
  StepBudget& budget_;
  std::size_t event_bytes_;

  Bins rows_;
  // In a step in which the scene changed so much that rows for what boxes are now would be bad ones for what they were,
  // every box before the step is a member of other rows than the box after it.
  bool apart_ = false;
  Bins rows_before_;
  int part_shift_ = 0;           // a part is 2^part_shift_ rows
  std::size_t parts_after_ = 1;  // of rows_; those of rows_before_ come next
  std::size_t steps_left_ = 0;   // until the next fit
  double crowding_ = 1;
  std::size_t fitted_objects_ = 0;
  std::size_t most_entries_ = 0;  // of all blocks
  double usual_entries_ = 0;      // of the first sweep after the fit
  double usual_meetings_ = 0;

  StepItems<Bin> bins_;
  StepItems<Sweep> sweeps_;
  StepItems<Scratch> scratch_;  // by worker
};

}  // namespace sweepgrid
