#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/sap/object_slots.hpp>

#include "op_script.hpp"

namespace sweepgrid::object_slots_test {
namespace {

/// Everything that can be asked agrees with `model`.
void expect_equal(const ObjectSlots& slots, const std::map<ObjectId, Slot>& model) {
  ASSERT_EQ(slots.size(), model.size());
  std::set<Slot> used;
  for (const auto& [object, slot] : model) {
    ASSERT_EQ(slots.find(object), slot);
    ASSERT_EQ(slots.object(slot), object);
    ASSERT_LT(slot, slots.slot_bound());
    ASSERT_TRUE(used.insert(slot).second) << "slot " << slot << " has two owners";
  }
  for (Slot slot = 0; slot < slots.slot_bound(); ++slot) {
    if (used.count(slot) == 0) {
      ASSERT_EQ(slots.object(slot), kNoObject);
    }
  }
}

TEST(ObjectSlots, IsEmptyAtFirst) {
  const ObjectSlots slots;
  EXPECT_EQ(slots.find(0), ObjectSlots::kAbsent);
  EXPECT_EQ(slots.find(kNoObject - 1), ObjectSlots::kAbsent);
  EXPECT_EQ(slots.size(), 0U);
  EXPECT_EQ(slots.slot_bound(), 0U);
}

// Ids that are drawn from few values collide, probe and shift; a model says what must come of it.
TEST(ObjectSlots, FindsExactlyTheObjectsThatHaveASlot) {
  for (const int ids : {4, 30, 500}) {
    for (const std::uint32_t stride : {1U, 8U, 1U << 16, 0x9e3779b1U, 0x80000001U}) {
      oracle::Random random(static_cast<std::uint64_t>(ids) * 31 + stride);
      ObjectSlots slots;
      std::map<ObjectId, Slot> model;
      for (int step = 0; step < 4 * ids + 200; ++step) {
        const ObjectId object = static_cast<ObjectId>(random.below(ids)) * stride;
        if (object == kNoObject) continue;
        const auto found = model.find(object);
        if (found == model.end()) {
          ASSERT_EQ(slots.find(object), ObjectSlots::kAbsent);
          model[object] = slots.acquire(object);
        } else {
          slots.release(object);
          model.erase(found);
          ASSERT_EQ(slots.find(object), ObjectSlots::kAbsent);
        }
        if (step % 16 == 0) expect_equal(slots, model);
      }
      expect_equal(slots, model);
    }
  }
}

TEST(ObjectSlots, ReusesSlotsSoThatTheyStayDense) {
  ObjectSlots slots;
  for (ObjectId object = 0; object < 100; ++object) slots.acquire(object);
  for (ObjectId round = 1; round < 50; ++round) {
    for (ObjectId object = 0; object < 100; ++object) slots.release((round - 1) * 100 + object);
    for (ObjectId object = 0; object < 100; ++object) slots.acquire(round * 100 + object);
  }
  EXPECT_EQ(slots.slot_bound(), 100U);
  EXPECT_EQ(slots.size(), 100U);
}

TEST(ObjectSlots, SlotsDoNotMoveWhileOthersComeAndGo) {
  ObjectSlots slots;
  const Slot kept = slots.acquire(77);
  for (ObjectId object = 1000; object < 1300; ++object) slots.acquire(object);
  for (ObjectId object = 1000; object < 1300; object += 2) slots.release(object);
  EXPECT_EQ(slots.find(77), kept);
  EXPECT_EQ(slots.object(kept), 77U);
}

}  // namespace
}  // namespace sweepgrid::object_slots_test
