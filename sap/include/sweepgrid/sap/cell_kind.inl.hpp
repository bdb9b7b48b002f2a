#pragma once

#include <memory>
#include <stdexcept>

#include <sweepgrid/sap/batch_sap.inl.hpp>
#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/classic_sap.hpp>
#include <sweepgrid/sap/row_cell.hpp>
#include <sweepgrid/sap/segmented_sap.inl.hpp>
#include <sweepgrid/sap/sweeping_plane.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
std::unique_ptr<SweepAndPrune<Scalar, Dim>> make_cell(const CellOptions& options) {
  switch (options.kind) {
    case CellKind::kRows:
      return std::make_unique<RowCell<Scalar, Dim>>();
    case CellKind::kBatch:
      return std::make_unique<BatchSap<Scalar, Dim>>();
    case CellKind::kSegmented:
      return std::make_unique<SegmentedSap<Scalar, Dim>>(options.segment_capacity, options.integration);
    case CellKind::kClassic:
      return std::make_unique<ClassicSap<Scalar, Dim>>();
    case CellKind::kPlane:
      return std::make_unique<SweepingPlane<Scalar, Dim>>();
  }
  throw std::invalid_argument("sweepgrid: unknown cell kind");
}

}  // namespace sweepgrid
