// Visitors of a row cell whose residents move at the same time: every changed pair, once, and no other.

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/sap/row_cell.hpp>
#include <sweepgrid/sap/row_kernels.hpp>

#include "op_script.hpp"
#include "visit_script.hpp"

namespace sweepgrid::row_cell_visits_test {
namespace {

using oracle::Regime;

/// The boxes of a step as refresh() asks for them.
template <class Scalar, int Dim>
struct StepOfBoxes {
  std::map<ObjectId, Box<Scalar, Dim>> old_boxes;
  std::map<ObjectId, Box<Scalar, Dim>> new_boxes;

  [[nodiscard]] bool changed(ObjectId object) const { return old_boxes.at(object) != new_boxes.at(object); }
  [[nodiscard]] const Box<Scalar, Dim>& after(ObjectId object) const { return new_boxes.at(object); }
};

// What is wrong, if anything.
template <class Scalar, int Dim>
std::string play(int population, int moving) {
  using Ordered = OrderedBox<Scalar, Dim>;
  RowCell<Scalar, Dim> cell;
  typename RowCell<Scalar, Dim>::RefreshScratch scratch;
  StepOfBoxes<Scalar, Dim> boxes;
  oracle::OpScript<Scalar, Dim> script(
      Regime{.name = "residents", .population = population, .moving_percent = moving, .churn_percent = 0}, 3);
  oracle::VisitScript<Scalar, Dim> visitors(oracle::Palette::kFine, 4);
  for (int step = 0; step < 8; ++step) {
    std::vector<CellOp<Scalar, Dim>> inserts;
    boxes.old_boxes = boxes.new_boxes;
    for (const auto& op : script.next()) {
      boxes.new_boxes[op.object] = op.box;
      if (op.kind == OpKind::kInsert)
        boxes.old_boxes[op.object] = op.box, inserts.push_back({op.object, op.kind, Ordered(op.box)});
    }
    SapCounters counters;
    cell.transfer(inserts, counters);
    std::vector<typename RowCell<Scalar, Dim>::Visit> visits;
    std::map<PairKey, std::vector<int>> expected;
    for (const auto& visit : visitors.next()) {
      visits.push_back({visit.object, visit.was, visit.is, Ordered(visit.before), Ordered(visit.after)});
      for (const auto& [object, box] : boxes.old_boxes) {
        const bool was = visit.was && Ordered(visit.before).overlaps(Ordered(box));
        const bool is = visit.is && Ordered(visit.after).overlaps(Ordered(boxes.new_boxes.at(object)));
        if (was != is) expected[PairKey(visit.object, object)] = {is ? +1 : -1};
      }
    }
    DeltaList deltas;
    cell.refresh(boxes, scratch, deltas, counters, visits);
    std::map<PairKey, std::vector<int>> told;
    for (const OverlapDelta& delta : deltas) {
      const bool of_residents =
          boxes.old_boxes.contains(delta.pair.lower()) && boxes.old_boxes.contains(delta.pair.upper());
      if (!of_residents) told[delta.pair].push_back(delta.change);
    }
    if (told != expected) return std::to_string(population) + " objects, step " + std::to_string(step);
  }
  return {};
}

class RowCellVisits : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { use_row_kernel_target(GetParam()); }
  void TearDown() override { use_row_kernel_target(""); }
};

TEST_P(RowCellVisits, MeetResidentsThatMoveMeanwhile) {
  for (const int population : {1, 7, 16, 17, 60}) {
    for (const int moving : {0, 30, 100}) {
      EXPECT_EQ((play<float, 3>(population, moving)), "") << "float, 3 axes";
      EXPECT_EQ((play<double, 2>(population, moving)), "") << "double, 2 axes";
      EXPECT_EQ((play<float, 5>(population, moving)), "") << "float, 5 axes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, RowCellVisits, testing::ValuesIn(row_kernel_targets()),
                         [](const auto& given) { return given.param; });

}  // namespace
}  // namespace sweepgrid::row_cell_visits_test
