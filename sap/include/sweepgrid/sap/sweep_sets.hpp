#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>

namespace sweepgrid {

/// The three sets of section 3.2.1: objects whose interval is open at the sweeping line of the retained list (S_L), of
/// the inserts (S_I) and of the erases (S_R). An object is in at most one of them at a time.
class SweepSets {
 public:
  enum Set { kRetained, kInserted, kErased };

  SweepSets(std::size_t slot_bound, std::pmr::memory_resource* memory)
      : members_{Members(memory), Members(memory), Members(memory)}, index_(slot_bound, memory) {}

  void add(Set set, Slot slot) {
    index_[slot] = static_cast<std::uint32_t>(members_[set].size());
    members_[set].push_back(slot);
  }

  void remove(Set set, Slot slot) {
    Members& members = members_[set];
    const Slot last = members.back();
    members[index_[slot]] = last;
    index_[last] = index_[slot];
    members.pop_back();
  }

  [[nodiscard]] const std::pmr::vector<Slot>& members(Set set) const { return members_[set]; }

 private:
  using Members = std::pmr::vector<Slot>;
  std::array<Members, 3> members_;
  std::pmr::vector<std::uint32_t> index_;  // by slot: its place among its set's members
};

}  // namespace sweepgrid
