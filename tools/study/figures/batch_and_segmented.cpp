#include "study/figures/batch_and_segmented.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "study/figures/figure_plans.hpp"

namespace sweepgrid::study {

std::optional<double> slope(const Results& results, const std::string& figure, const std::string& system, double from,
                            double to) {
  const Entry* first = results.find(figure, system, from);
  const Entry* last = results.find(figure, system, to);
  if (first == nullptr || last == nullptr) return std::nullopt;
  return (median_seconds(*last) - median_seconds(*first)) / (to - from);
}

std::optional<double> quotient(const std::optional<double>& above, const std::optional<double>& below) {
  return above && below ? std::optional(*above / *below) : std::nullopt;
}

std::string cost_text(const Results& results, const std::string& figure, const std::string& batch,
                      const std::string& segmented, double from, double to, const char* unit) {
  const auto line = [&](const std::string& system) -> std::string {
    const auto each = slope(results, figure, system, from, to);
    if (!each) return "a time that was not measured";
    const double base = median_seconds(*results.find(figure, system, from)) - *each * from;
    return fmt::format("{:.0f} µs and {:.0f} ns for each {}", 1e6 * base, 1e9 * *each, unit);
  };
  return fmt::format("Between {} and {}, a batch step takes {}, a segmented one {}.", from, to, line(batch),
                     line(segmented));
}

std::string sorts_text(const Results& results, const std::string& figure, double x) {
  const auto share = [&](CellKind kind) {
    const Entry* entry = results.find(figure, system_name::grid(kind), x);
    if (entry == nullptr) return 0.0;
    const SapCounters& cells = entry->work.cells;
    const auto all = static_cast<double>(cells.global_sorts + cells.local_sorts);
    return all == 0 ? 0.0 : 100 * static_cast<double>(cells.global_sorts) / all;
  };
  return fmt::format(
      "Objects that change cells are inserts and erases to them: at x = {}, {:.0f} % of the drains of batch cells pass "
      "over all lists, {:.0f} % of those of segmented cells.",
      x, share(CellKind::kBatch), share(CellKind::kSegmented));
}

namespace {

std::string work_text(const Entry& entry) {
  return fmt::format("{:.0f} box tests and {:.0f} swaps", entry.per_step(entry.work.cells.box_tests),
                     entry.per_step(entry.work.cells.swaps));
}

}  // namespace

std::optional<Worst> presorted_at_worst(const Results& results, const std::string& figure, const std::string& batch,
                                        const std::string& segmented, const std::string& presorted) {
  std::optional<Worst> worst;
  for (const Entry* entry : results.series(figure, presorted)) {
    const Entry* first = results.find(figure, batch, entry->x);
    const Entry* second = results.find(figure, segmented, entry->x);
    if (first == nullptr || second == nullptr) continue;
    const double batch_seconds = median_seconds(*first);
    const double segmented_seconds = median_seconds(*second);
    const double ratio = median_seconds(*entry) / std::min(batch_seconds, segmented_seconds);
    if (worst && ratio <= worst->ratio) continue;
    worst = Worst{entry->x, ratio, batch_seconds < segmented_seconds, median_seconds(*entry) / segmented_seconds,
                  fmt::format("A presorted step takes {}, a batch step {}.", work_text(*entry), work_text(*first))};
  }
  return worst;
}

std::string at_text(const std::optional<Worst>& worst) { return worst ? fmt::format(", at {} events", worst->x) : ""; }

std::optional<double> ratio_of(const std::optional<Worst>& worst) {
  return worst ? std::optional(worst->ratio) : std::nullopt;
}

std::string presorted_reason(const std::optional<Worst>& worst) {
  if (!worst) return "";
  return fmt::format(
      "There {} the better, and segmented lists take {:.2f} times as long with presorting as without. {}",
      worst->batch_is_better ? "batch is" : "segmented lists are", worst->beside_plain, worst->work);
}

}  // namespace sweepgrid::study
