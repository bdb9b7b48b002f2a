#pragma once

#include <string>
#include <vector>

#include "study/figures/contest.hpp"

namespace sweepgrid::study {

/// The figures: those of the paper by number, then the measurements that other claims need. Their points' x:
namespace figure {
inline constexpr const char* k2 = "2";                        ///< objects, all moving
inline constexpr const char* k8 = "8";                        ///< moving of 3000
inline constexpr const char* k9 = "9";                        ///< inserts and erases per step
inline constexpr const char* k10 = "10";                      ///< inserts and erases per step
inline constexpr const char* k11 = "11";                      ///< objects
inline constexpr const char* kPopulation = "population";      ///< objects per cell
inline constexpr const char* kSegments = "segments";          ///< endpoints per segment
inline constexpr const char* kSorts = "sorts";                ///< objects in a cell, all moving
inline constexpr const char* kCoherence = "coherence";        ///< share of objects that moves
inline constexpr const char* kSpeed = "speed";                ///< widths per step
inline constexpr const char* kClumped = "clumped";            ///< share of objects that moves
inline constexpr const char* kReplaced = "replaced";          ///< share of objects that is replaced per step
inline constexpr const char* kFlat = "two dimensions";        ///< objects, all moving
inline constexpr const char* kInsertWork = "insertion work";  ///< objects, none moving
inline constexpr const char* kQuiet = "quiet";                ///< objects, none moving, none coming or going
}  // namespace figure

/// The systems by their names in the report.
namespace system_name {
[[nodiscard]] std::string one_cell(CellKind kind);
[[nodiscard]] std::string grid(CellKind kind);
inline constexpr const char* kOctree = "octree";
inline constexpr const char* kEngine = "engine, as it chooses";
inline constexpr const char* kPresortedCell = "segmented presorted, one cell";
inline constexpr const char* kPresortedGrid = "segmented presorted, grid";
inline constexpr const char* kUniformSuffix = ", uniform";  ///< in kClumped: the same without clumps
inline constexpr const char* kAutoCell = "segmented presorted if it pays, one cell";
inline constexpr const char* kAutoGrid = "segmented presorted if it pays, grid";
// The workloads of kSegments.
inline constexpr const char* kSegmentsEvents = "ten inserts and ten erases";
inline constexpr const char* kSegmentsSort = "a fifth of 3000 moving";
// The ways to sort of kSorts.
inline constexpr const char* kBatchGlobal = "batch, global sort";
inline constexpr const char* kBatchLocal = "batch, local sort in 4 drains";
inline constexpr const char* kSegmentedGlobal = "segmented, global sort";
inline constexpr const char* kSegmentedLocal = "segmented, local sort in 5 drains";
inline constexpr const char* kFewMovingGlobal = "classic (global sort), 5 % moving";
inline constexpr const char* kFewMovingLocal = "batch (local sort), 5 % moving";
}  // namespace system_name

/// A contest that belongs to a figure.
struct FigurePoint {
  std::string figure;
  std::string name;  ///< unique within the figure
  ContestPlan plan;
  double cost = 1;  ///< expected seconds
};

/// All points of `figures`; empty: of all figures and all other measurements.
[[nodiscard]] std::vector<FigurePoint> figure_points(bool quick, const std::vector<std::string>& figures);

}  // namespace sweepgrid::study
