#include "standard_scenes.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace sweepgrid::bench {
namespace {

/// A generator with the parameters that make it a sort of its own; `moving` and `churn` are told always, because
/// generators have defaults for both.
struct Sort {
  const char* name;
  const char* generator;
  double moving;
  double churn;
};

constexpr Sort kUniformFew{"uniform, 10 % move", "uniform", 0.1, 0};
constexpr Sort kUniformAll{"uniform, all move", "uniform", 1, 0};
constexpr Sort kUniformChurn{"uniform, 10 % move, churn .005", "uniform", 0.1, 0.005};
constexpr Sort kClustersFew{"clustered, 10 % move", "clusters", 0.1, 0};
constexpr Sort kClustersAll{"clustered, all move", "clusters", 1, 0};
constexpr Sort kSizesFew{"sizes, 10 % move", "sizes", 0.1, 0};
constexpr Sort kSizesAll{"sizes, all move", "sizes", 1, 0};
constexpr Sort kPileFew{"pile, 10 % move", "pile", 0.1, 0};
constexpr Sort kPileAll{"pile, all move", "pile", 1, 0};
constexpr Sort kTeleport{"teleport, 10 % jump", "teleport", 0.1, 0};
constexpr Sort kResting{"resting, 0.1 % move", "uniform", 0.001, 0};

NamedScene scene_of(const Sort& sort, std::uint64_t objects, std::uint64_t steps) {
  return {fmt::format("{} {}", objects, sort.name),
          fmt::format("{}:n={},moving={},churn={},steps={}", sort.generator, objects, sort.moving, sort.churn, steps)};
}

}  // namespace

std::vector<NamedScene> standard_scenes() {
  constexpr std::uint64_t kSteps = 50;
  std::vector<NamedScene> scenes;
  for (const Sort& sort : {kUniformFew, kUniformAll}) scenes.push_back(scene_of(sort, 10000, kSteps));
  for (const Sort& sort : {kUniformFew, kUniformAll, kUniformChurn}) scenes.push_back(scene_of(sort, 100000, kSteps));
  for (const Sort& sort : {kClustersFew, kClustersAll, kSizesFew, kSizesAll, kPileFew, kPileAll, kTeleport}) {
    scenes.push_back(scene_of(sort, 20000, kSteps));
  }
  scenes.push_back(scene_of(kResting, 100000, kSteps));
  return scenes;
}

std::vector<NamedScene> large_scenes() {
  constexpr std::uint64_t kSteps = 10;
  std::vector<NamedScene> scenes;
  for (const Sort& sort : {kClustersAll, kPileAll}) scenes.push_back(scene_of(sort, 100000, kSteps));
  for (const Sort& sort : {kUniformFew, kUniformAll, kUniformChurn, kResting}) {
    scenes.push_back(scene_of(sort, 1000000, kSteps));
  }
  return scenes;
}

std::vector<NamedScene> small_scenes(std::uint64_t objects, std::uint64_t steps) {
  std::vector<NamedScene> scenes;
  for (const Sort& sort : {kUniformFew, kUniformAll, kUniformChurn, kClustersFew, kClustersAll, kSizesFew, kSizesAll,
                           kPileFew, kPileAll, kTeleport, kResting}) {
    scenes.push_back(scene_of(sort, objects, steps));
  }
  return scenes;
}

std::vector<NamedScene> recordings(const std::string& directory) {
  std::vector<NamedScene> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const std::filesystem::path& path = entry.path();
    if (entry.is_regular_file() && path.extension() != ".md") scenes.push_back({path.filename(), path});
  }
  std::sort(scenes.begin(), scenes.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return scenes;
}

}  // namespace sweepgrid::bench
