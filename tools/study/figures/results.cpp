#include "study/figures/results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/in_turn.hpp"

namespace sweepgrid::study {

std::vector<std::string> Results::systems(const std::string& figure) const {
  std::vector<std::string> names;
  for (const Played& played : played_) {
    if (played.figure != figure) continue;
    for (const Entry& entry : played.contest.entries) {
      if (std::find(names.begin(), names.end(), entry.system) == names.end()) names.push_back(entry.system);
    }
  }
  return names;
}

std::vector<const Entry*> Results::series(const std::string& figure, const std::string& system) const {
  std::vector<const Entry*> result;
  for (const Played& played : played_) {
    if (played.figure != figure) continue;
    for (const Entry& entry : played.contest.entries) {
      if (entry.system == system) result.push_back(&entry);
    }
  }
  std::sort(result.begin(), result.end(), [](const Entry* a, const Entry* b) { return a->x < b->x; });
  return result;
}

const Entry* Results::find(const std::string& figure, const std::string& system, double x) const {
  for (const Entry* entry : series(figure, system)) {
    if (std::abs(entry->x - x) <= 1e-9 * std::abs(x)) return entry;
  }
  return nullptr;
}

std::optional<Spread> Results::times_faster(const std::string& figure, double x, const std::string& slow,
                                            const std::string& fast) const {
  const Entry* above = find(figure, slow, x);
  const Entry* below = find(figure, fast, x);
  if (above == nullptr || below == nullptr) return std::nullopt;
  return spread(ratios(above->seconds, below->seconds));
}

std::optional<Spread> Results::times_faster_at_last(const std::string& figure, const std::string& slow,
                                                    const std::string& fast) const {
  std::optional<Spread> last;
  for (const Entry* entry : series(figure, slow)) {
    if (const auto here = times_faster(figure, entry->x, slow, fast)) last = here;
  }
  return last;
}

std::optional<PowerLaw> Results::law(const std::string& figure, const std::string& system, const Figure& value,
                                     double least_x) const {
  std::vector<double> x;
  std::vector<double> y;
  for (const Entry* entry : series(figure, system)) {
    if (!(value(*entry) > 0) || !(entry->x > 0) || entry->x < least_x) continue;
    x.push_back(entry->x);
    y.push_back(value(*entry));
  }
  if (x.size() < 3) return std::nullopt;
  return fit_power_law(x, y);
}

std::optional<double> Results::crossing(const std::string& figure, const std::string& first,
                                        const std::string& second) const {
  std::optional<double> last_x;
  double last_log = 0;
  bool measured = false;
  // From the far end: noise at the near end must not pass for a crossing.
  std::vector<const Entry*> entries = series(figure, first);
  std::reverse(entries.begin(), entries.end());
  for (const Entry* entry : entries) {
    const auto ratio = times_faster(figure, entry->x, first, second);
    if (!ratio) continue;
    measured = true;
    const double log = std::log(ratio->median);
    if (log < 0) {
      if (!last_x) return std::numeric_limits<double>::infinity();
      return entry->x + (*last_x - entry->x) * -log / (last_log - log);
    }
    last_x = entry->x;
    last_log = log;
  }
  return measured ? std::optional<double>(0) : std::nullopt;
}

}  // namespace sweepgrid::study
