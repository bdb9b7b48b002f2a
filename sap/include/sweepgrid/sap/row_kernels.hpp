#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <sweepgrid/sap/delta_list.hpp>
#include <sweepgrid/sap/row_block.hpp>
#include <sweepgrid/sap/row_views.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// What RowCell does with vector instructions: compiled once for each instruction set, chosen by what the machine has.
/// The calls mean what those of SweepAndPrune mean. drain() and transfer() return the index of an op that they refuse,
/// and have then changed nothing, or the number of ops.
template <class Bits, int Dim>
struct RowKernels {
  using Block = RowBlock<Bits, Dim>;
  using Ops = OpViews<Bits, Dim>;
  using Visits = VisitViews<Bits, Dim>;

  /// Others do not exist: see RowScalars.
  static constexpr bool kCompiled =
      (std::is_same_v<Bits, std::uint32_t> || std::is_same_v<Bits, std::uint64_t>)&&Dim >= 1 && Dim <= 4;

  static std::size_t drain(Block& block, Ops ops, DeltaList& deltas, SapCounters& counters);
  static std::size_t transfer(Block& block, Ops ops);
  /// Gives every object the box that `boxes` holds at its place, Dim mins and then Dim maxes. At all places but the
  /// `moved` ones it is the box that the object has.
  static void refresh(Block& block, const Bits* boxes, std::span<const std::uint32_t> moved, DeltaList& deltas,
                      SapCounters& counters);
  /// `boxes` as for refresh(): visitors meet residents as they are with the box that they had, and with the box that
  /// they have as residents will be after it. Null: residents rest.
  static void visit(const Block& block, const Bits* boxes, Visits visits, DeltaList& deltas, SapCounters& counters);
};

/// The instruction sets that this machine has kernels for, best first. For tests.
[[nodiscard]] std::vector<std::string> row_kernel_targets();

/// Has all later calls use the kernels for one of row_kernel_targets(), or the best again if `target` is empty. Throws
/// std::invalid_argument for any other name. For tests; not beside any other call.
void use_row_kernel_target(const std::string& target);

}  // namespace sweepgrid
