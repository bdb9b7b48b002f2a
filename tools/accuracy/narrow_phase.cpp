#include "accuracy/narrow_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <stdexcept>

#include "accuracy/truth.hpp"
#include "measure/stopwatch.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid::accuracy {
namespace {

using baselines::PlacedBox;
using baselines::PlacedPairs;
// Of Bullet 3.24, by measure_narrow_phase("bullet").
constexpr double kNarrowPhaseNs = 153;
constexpr const char* kNarrowPhaseSource = "bullet, box-box, measured on an AMD EPYC";

using Test = std::function<std::size_t(const PlacedPairs&)>;

std::map<std::string, Test, std::less<>> tests() {
  std::map<std::string, Test, std::less<>> tests;
#ifdef SWEEPGRID_WITH_BULLET
  tests["bullet"] = baselines::bullet_touching;
#endif
#ifdef SWEEPGRID_WITH_FCL
  tests["fcl"] = baselines::fcl_touching;
#endif
  return tests;
}

PlacedBox placed(const OrientedBox& box) {
  PlacedBox result;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const auto& [x, y, z] = box.half_edges[edge];
    const double length = std::sqrt(x * x + y * y + z * z);
    result.half[edge] = static_cast<float>(length);
    for (std::size_t i = 0; i < 3; ++i) {
      result.axes[edge][i] = static_cast<float>(box.half_edges[edge][i] / length);
      result.centre[i] = static_cast<float>(box.centre[i]);
    }
  }
  return result;
}

}  // namespace

PlacedPairs narrow_phase_candidates() {
  const auto scene = open_scene("turning:n=5000,steps=0,density=0.5");
  SceneStep start;
  scene->next(start);
  PlacedPairs candidates;
  // The keys of the first objects are their places in the lists.
  const auto truth = make_truth(TruthKind::kInstants, scene->info());
  for (const auto& [a, b] : truth->step(start)) {
    candidates.emplace_back(placed(start.inserted_shapes[a]), placed(start.inserted_shapes[b]));
  }
  return candidates;
}

std::vector<std::string> narrow_phases() {
  std::vector<std::string> names;
  for (const auto& [name, test] : tests()) names.push_back(name);
  return names;
}

NarrowPhasePrice measure_narrow_phase(std::string_view name) {
  const auto known = tests();
  const auto test = known.find(name);
  if (test == known.end()) throw std::invalid_argument("no narrow phase '" + std::string(name) + "' in this program");
  const PlacedPairs candidates = narrow_phase_candidates();
  std::array<double, 7> samples{};
  for (double& sample : samples) {
    const ThreadStopwatch time;
    if (test->second(candidates) == 0) throw std::logic_error("no candidate touches");
    sample = 1e9 * time.seconds() / static_cast<double>(candidates.size());
  }
  std::sort(samples.begin(), samples.end());
  return {samples[samples.size() / 2], samples.front(), samples.back(), test->first + ", box-box, measured here"};
}

NarrowPhasePrice default_narrow_phase_price() {
  for (const std::string& name : narrow_phases()) return measure_narrow_phase(name);
  return {kNarrowPhaseNs, kNarrowPhaseNs, kNarrowPhaseNs, kNarrowPhaseSource};
}

}  // namespace sweepgrid::accuracy
