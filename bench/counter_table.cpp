#include "counter_table.hpp"

#include <iterator>
#include <variant>

namespace sweepgrid::bench {
namespace {

struct Counter {
  const char* name;
  std::variant<std::uint64_t StepCounters::*, std::uint64_t SapCounters::*> member;
};

constexpr Counter kCounters[] = {
    {"inserts", &StepCounters::inserts},
    {"updates", &StepCounters::updates},
    {"erases", &StepCounters::erases},
    {"migrations", &StepCounters::migrations},
    {"sweeps", &StepCounters::sweeps},
    {"cell_ops", &StepCounters::cell_ops},
    {"cells_drained", &StepCounters::cells_drained},
    {"regrids", &StepCounters::regrids},
    {"begins", &StepCounters::begins},
    {"ends", &StepCounters::ends},
    {"swaps", &SapCounters::swaps},
    {"box_tests", &SapCounters::box_tests},
    {"deltas", &SapCounters::deltas},
    {"endpoints_visited", &SapCounters::endpoints_visited},
    {"endpoints_sorted", &SapCounters::endpoints_sorted},
    {"search_steps", &SapCounters::search_steps},
    {"local_sorts", &SapCounters::local_sorts},
    {"global_sorts", &SapCounters::global_sorts},
    {"segments_split", &SapCounters::segments_split},
    {"segments_merged", &SapCounters::segments_merged},
};
static_assert(sizeof(StepCounters) == std::size(kCounters) * sizeof(std::uint64_t),
              "a counter has no row in kCounters");

struct Bytes {
  const char* name;
  std::size_t Stats::*member;
};

constexpr Bytes kBytes[] = {
    {"bytes_objects", &Stats::bytes_objects},
    {"bytes_cells", &Stats::bytes_cells},
    {"bytes_queues", &Stats::bytes_queues},
    {"bytes_witnesses", &Stats::bytes_witnesses},
};

std::uint64_t value(const StepCounters& counters, const Counter& counter) {
  if (const auto* of_step = std::get_if<std::uint64_t StepCounters::*>(&counter.member)) return counters.*(*of_step);
  return counters.cells.*std::get<std::uint64_t SapCounters::*>(counter.member);
}

}  // namespace

std::vector<NamedCount> named_counts(const StepCounters& counters) {
  std::vector<NamedCount> counts;
  for (const Counter& counter : kCounters) counts.push_back({counter.name, value(counters, counter)});
  return counts;
}

std::vector<NamedCount> named_bytes(const Stats& stats) {
  std::vector<NamedCount> counts;
  for (const Bytes& bytes : kBytes) counts.push_back({bytes.name, stats.*bytes.member});
  return counts;
}

}  // namespace sweepgrid::bench
