#pragma once

#include <stdexcept>
#include <string>

#include <sweepgrid/sap/cell_op.hpp>

namespace sweepgrid {

/// Throws the std::invalid_argument of SweepAndPrune::drain() for an op that inserts a present object, or that updates
/// or erases an absent one.
template <class Scalar, int Dim>
[[noreturn]] void refuse_op(const CellOp<Scalar, Dim>& op) {
  const bool insert = op.kind == OpKind::kInsert;
  throw std::invalid_argument("sweepgrid: cell was told to " +
                              std::string(insert                       ? "insert"
                                          : op.kind == OpKind::kUpdate ? "update"
                                                                       : "erase") +
                              " object " + std::to_string(op.object) +
                              (insert ? ", which it has already" : ", which it does not have"));
}

}  // namespace sweepgrid
