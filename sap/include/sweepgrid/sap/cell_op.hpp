#pragma once

#include <cstdint>

#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/ordered_box.hpp>

namespace sweepgrid {

enum class OpKind : std::uint32_t { kInsert, kUpdate, kErase };

/// A buffered change of one object as one cell hears of it. `box` is the new box; an erase ignores it.
template <class Scalar, int Dim>
struct CellOp {
  ObjectId object = kNoObject;
  OpKind kind = OpKind::kUpdate;
  OrderedBox<Scalar, Dim> box;
};

}  // namespace sweepgrid
