#include "scene_truth.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sweepgrid::bench {
namespace {

std::vector<ObjectPair> overlapping(const OverlapOracle& oracle) {
  std::vector<ObjectPair> pairs;
  for (const auto& [a, b] : oracle.pairs()) {
    pairs.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
  }
  return pairs;
}

std::vector<ObjectPair> sorted(std::vector<ObjectPair> pairs) {
  for (auto& [a, b] : pairs) {
    if (a > b) std::swap(a, b);
  }
  std::sort(pairs.begin(), pairs.end(), [](const ObjectPair& a, const ObjectPair& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return pairs;
}

std::string text(const SceneBox& box) {
  return fmt::format("[{}]..[{}]", fmt::join(box.min, " "), fmt::join(box.max, " "));
}

}  // namespace

SceneTruth::SceneTruth(const SceneScript& script) : script_(script) {
  constexpr std::size_t kQuarters = 4;
  const std::size_t last = script.steps.size() - 1;
  for (std::size_t quarter = 0; quarter <= kQuarters; ++quarter) digests_[last * quarter / kQuarters];
  digests_[script.steps.size()];
  OverlapOracle oracle;
  for (std::size_t step = 0; step <= script.steps.size(); ++step) {
    advance(step, oracle);
    if (knows(step)) digests_[step] = digest(overlapping(oracle));
  }
}

void SceneTruth::advance(std::size_t step, OverlapOracle& oracle) const {
  const ScriptStep& changes = step < script_.steps.size() ? script_.steps[step] : script_.removal;
  oracle.apply(scene_step(changes));
}

std::string SceneTruth::complaint(std::size_t step, const std::vector<ObjectPair>& pairs) const {
  if (digest(pairs) == after(step)) return "";
  // Rare, so the boxes are not kept but found again.
  OverlapOracle oracle;
  for (std::size_t past = 0; past <= step; ++past) advance(past, oracle);
  const std::vector<ObjectPair> told = sorted(pairs);
  const std::vector<ObjectPair> truth = sorted(overlapping(oracle));
  const auto [wrong, missed] = std::mismatch(told.begin(), told.end(), truth.begin(), truth.end());
  const std::string where = fmt::format("step {}: {} pairs, should be {}", step, told.size(), truth.size());
  const bool missing = wrong == told.end() || (missed != truth.end() && std::tie(missed->first, missed->second) <
                                                                            std::tie(wrong->first, wrong->second));
  const auto [a, b] = missing ? *missed : *wrong;
  const auto box = [&](std::uint32_t object) {
    return oracle.contains(object) ? text(oracle.box(object)) : "not there";
  };
  const bool twice = !missing && wrong != told.begin() && *(wrong - 1) == *wrong;
  return fmt::format("{}; first {}: {} and {}, boxes {} and {}", where,
                     missing ? "missing"
                     : twice ? "told twice"
                             : "not overlapping",
                     a, b, box(a), box(b));
}

}  // namespace sweepgrid::bench
