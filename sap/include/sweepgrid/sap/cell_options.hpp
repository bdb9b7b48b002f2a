#pragma once

namespace sweepgrid {

/// The kinds of cell. All give the same overlaps; they differ in what makes them fast.
enum class CellKind {
  kRows,       ///< rows of coordinates, compared with vector instructions: cells of few objects, however they move
  kBatch,      ///< batch insertion and removal (section 3.2.1): most objects move, or many come and go
  kSegmented,  ///< segmented interval lists (section 3.2.2): few objects move, few come and go
  kClassic,    ///< Baraff's sweep and prune: a baseline
  kPlane,      ///< non-incremental sweeping plane: a baseline
};

/// How segmented cells apply the inserts and erases of a drain.
enum class Integration {
  kAuto,       ///< presorted from the measured number of inserts and erases on (sap/README.md)
  kOneByOne,   ///< each by a search of its own (section 3.2.2)
  kPresorted,  ///< sorted, then segment by segment in one pass: what sections 4.1 and 4.2 suggest
};

/// Settings of a cell; the defaults are measured (see sap/README.md).
struct CellOptions {
  CellKind kind = CellKind::kRows;
  /// Endpoints per segment, 4 to kMostSegmentCapacity (kSegmented only; the paper finds about 2^5). Every axis of
  /// every cell holds memory for at least one segment.
  int segment_capacity = 32;
  static constexpr int kMostSegmentCapacity = 1 << 16;
  /// kSegmented only. All choices give the same overlaps; the others than kAuto are for studies.
  Integration integration = Integration::kAuto;
};

}  // namespace sweepgrid
