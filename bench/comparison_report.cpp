#include "comparison_report.hpp"

#include <fmt/format.h>

namespace sweepgrid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kRow = "  {:<18} {:>9} {:>9} {:>21} {:>8} {:>8} {:>15} {:>15} {:>8} {:>9} {:>9} {:>9}\n";

// "12.3 (4.5x)": milliseconds, and how many times faster than the first contestant.
std::string milliseconds(const Rounds& rounds, std::size_t i, double Run::*figure) {
  return fmt::format("{:.1f} ({:.2f}x)", 1e3 * rounds.of(i, figure).median, rounds.times_less(i, figure).median);
}

void print_row(const Rounds& rounds, std::size_t i) {
  const Run& last = rounds.last(i);
  const Spread faster = rounds.times_less(i, &Run::ns_per_update);
  fmt::print(kRow, rounds.name(i), fmt::format("{:.1f}", rounds.of(i, &Run::ns_per_update).median),
             fmt::format("{:.1f}", rounds.of(i, &Run::step_only_ns_per_update).median),
             fmt::format("{:.2f} ({:.2f}-{:.2f})", faster.median, faster.low, faster.high),
             fmt::format("{:.2f}", rounds.of(i, &Run::p99_over_mean).median),
             fmt::format("{:.2f}", rounds.of(i, &Run::max_over_median).median),
             milliseconds(rounds, i, &Run::first_insertion), milliseconds(rounds, i, &Run::removal),
             fmt::format("{:.0f}", rounds.of(i, &Run::bytes_per_object).median), last.pairs.count,
             last.events ? fmt::format("{}", last.events->begins) : "-",
             last.events ? fmt::format("{}", last.events->ends) : "-");
}

Json spread_json(const Spread& spread, double unit = 1) {
  return {{"median", spread.median * unit}, {"min", spread.low * unit}, {"max", spread.high * unit}};
}

Json contestant_json(const Rounds& rounds, std::size_t i) {
  constexpr double kMilli = 1e3;
  const Run& last = rounds.last(i);
  const auto event_count = [&](std::uint64_t EventTotals::*count) {
    return last.events ? Json((*last.events).*count) : Json(nullptr);
  };
  return {{"system", rounds.name(i)},
          {"ns_per_update", spread_json(rounds.of(i, &Run::ns_per_update))},
          {"times_faster", spread_json(rounds.times_less(i, &Run::ns_per_update))},
          {"step_only_ns_per_update", spread_json(rounds.of(i, &Run::step_only_ns_per_update))},
          {"p99_over_mean", spread_json(rounds.of(i, &Run::p99_over_mean))},
          {"max_over_median", spread_json(rounds.of(i, &Run::max_over_median))},
          {"first_insertion_ms", spread_json(rounds.of(i, &Run::first_insertion), kMilli)},
          {"first_insertion_times_faster", spread_json(rounds.times_less(i, &Run::first_insertion))},
          {"removal_ms", spread_json(rounds.of(i, &Run::removal), kMilli)},
          {"removal_times_faster", spread_json(rounds.times_less(i, &Run::removal))},
          {"bytes_per_object", rounds.of(i, &Run::bytes_per_object).median},
          {"heap_bytes_per_object", rounds.of(i, &Run::heap_bytes_per_object).median},
          {"pairs", last.pairs.count},
          {"pairs_hash", fmt::format("{:016x}", last.pairs.hash)},
          {"begins", event_count(&EventTotals::begins)},
          {"ends", event_count(&EventTotals::ends)},
          {"complaints", rounds.complaints(i)}};
}

}  // namespace

void print_table(const Rounds& rounds) {
  fmt::print(kRow, "system", "ns/update", "in step()", "x faster than " + rounds.name(0), "p99/mean", "max/med",
             "insert ms", "remove half ms", "bytes/ob", "pairs", "begins", "ends");
  for (std::size_t i = 0; i < rounds.size(); ++i) print_row(rounds, i);
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const auto& complaints = rounds.complaints(i);
    if (complaints.empty()) continue;
    fmt::print("  WRONG: {}: {}{}\n", rounds.name(i), complaints.front(),
               complaints.size() > 1 ? fmt::format(" (and {} more)", complaints.size() - 1) : "");
  }
}

Json to_json(const Rounds& rounds) {
  Json json = Json::array();
  for (std::size_t i = 0; i < rounds.size(); ++i) json.push_back(contestant_json(rounds, i));
  return json;
}

}  // namespace sweepgrid::bench
