// How far the engine is from what the machine must do in any case: bring the new boxes to where the objects are.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine_setting.hpp"
#include "figures_file.hpp"
#include "measure/spread.hpp"
#include "measure/stopwatch.hpp"
#include "system.hpp"

namespace sweepgrid::bench {
namespace {

using Json = nlohmann::ordered_json;

/// What a broad phase could keep of an object at least, in a cache line of its own.
struct alignas(64) ObjectRecord {
  FloatBox box;
};

/// The boxes of a script's updates, and a table in which they belong at random.
class Traffic {
 public:
  explicit Traffic(const SceneScript& script) : script_(script), table_(script.objects), handles_(script.objects) {
    std::iota(handles_.begin(), handles_.end(), 0U);
    std::shuffle(handles_.begin(), handles_.end(), std::mt19937_64(1));
    copies_.resize(script.objects);
  }

  // Nanoseconds per box.
  double copy() {
    return measured([this](const auto& boxes) { std::copy(boxes.begin(), boxes.end(), copies_.begin()); });
  }
  double scatter() {
    return measured([this](const auto& boxes) {
      for (std::size_t i = 0; i < boxes.size(); ++i) table_[handles_[i]].box = boxes[i];
    });
  }
  double gather() {
    return measured([this](const auto& boxes) {
      for (std::size_t i = 0; i < boxes.size(); ++i) copies_[i] = table_[handles_[i]].box;
    });
  }

 private:
  template <class Pass>
  double measured(Pass&& pass) {
    constexpr std::size_t kBoxes = 2'000'000;  // enough for a clock
    std::size_t boxes = 0;
    // The first turn warms up.
    for (const ScriptStep& step : script_.steps) pass(step.updated_boxes);
    const WallStopwatch stopwatch;
    while (boxes < kBoxes) {
      for (const ScriptStep& step : script_.steps) {
        pass(step.updated_boxes);
        benchmark::ClobberMemory();  // every pass must have reached memory
        boxes += step.updated_boxes.size();
      }
    }
    return 1e9 * stopwatch.seconds() / static_cast<double>(boxes);
  }

  const SceneScript& script_;
  std::vector<ObjectRecord> table_;
  std::vector<std::uint32_t> handles_;
  std::vector<FloatBox> copies_;
};

/// Mean nanoseconds per update of whole steps after the start.
double engine_ns_per_update(const Config& config, const SceneScript& script) {
  EngineSystem system(config, false, script.objects);
  double seconds = 0;
  std::size_t changes = 0;
  for (const ScriptStep& step : script.steps) {
    const WallStopwatch stopwatch;
    system.queue(step);
    system.step();
    if (&step == &script.steps.front()) continue;
    seconds += stopwatch.seconds();
    changes += step.changes();
  }
  return 1e9 * seconds / static_cast<double>(changes);
}

Json figures(std::uint64_t objects, double moving, int rounds, const Config& config) {
  constexpr std::uint64_t kSteps = 10;
  const SceneScript script = read_script(fmt::format("uniform:n={},moving={},churn=0", objects, moving), kSteps);
  std::vector<double> copies, scatters, gathers, engines, ratios;
  Traffic traffic(script);
  for (int round = 0; round < rounds; ++round) {
    copies.push_back(traffic.copy());
    scatters.push_back(traffic.scatter());
    gathers.push_back(traffic.gather());
    engines.push_back(engine_ns_per_update(config, script));
    ratios.push_back(engines.back() / scatters.back());
  }
  const Spread ratio = spread(ratios);
  Json json = {{"objects", objects},
               {"moving", moving},
               {"copy_ns", spread(copies).median},
               {"scatter_ns", spread(scatters).median},
               {"gather_ns", spread(gathers).median},
               {"engine_ns", spread(engines).median},
               {"engine_over_scatter", {{"median", ratio.median}, {"min", ratio.low}, {"max", ratio.high}}}};
  fmt::print("{:>9} {:>7.0f} % {:>8.2f} {:>8.2f} {:>8.2f} {:>9.1f} {:>6.1f} ({:.1f}-{:.1f})\n", objects, 100 * moving,
             json["copy_ns"].get<double>(), json["scatter_ns"].get<double>(), json["gather_ns"].get<double>(),
             json["engine_ns"].get<double>(), ratio.median, ratio.low, ratio.high);
  std::fflush(stdout);
  return json;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Beside each other, on one thread: the engine's whole steps in the uniform scene, and what it would cost to do "
      "no "
      "more with its new boxes than to copy them in order (24 bytes each), to scatter them into a table of 64-byte "
      "records, one for each object, in random order, or to gather as many from there. In ns per box or update.");
  std::vector<std::uint64_t> sizes = {10'000, 100'000, 1'000'000};
  int rounds = 5;
  std::string setting = "engine";
  std::string json_file;
  // Fewer, and nothing would move.
  app.add_option("sizes", sizes, "Numbers of objects")->check(CLI::Range(100, 100'000'000))->capture_default_str();
  app.add_option("--rounds", rounds, "Times that all is measured in turn")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--system", setting, "The engine's setting: " + engine_setting_help())->capture_default_str();
  app.add_option("--json", json_file, "Also write the figures here");
  CLI11_PARSE(app, argc, argv);
  const auto config = engine_setting(setting);
  if (!config) throw std::invalid_argument("--system: there is no " + setting);

  fmt::print("{:>9} {:>9} {:>8} {:>8} {:>8} {:>9} {}\n", "objects", "moving", "copy", "scatter", "gather", setting,
             "engine / scatter");
  Json rows = Json::array();
  for (const std::uint64_t objects : sizes) {
    for (const double moving : {0.1, 1.0}) rows.push_back(figures(objects, moving, rounds, *config));
  }
  if (!json_file.empty()) write_figures(json_file, "sweepgrid-limits", {{"rounds", rounds}, {"limits", rows}});
  return 0;
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  try {
    return sweepgrid::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "limits: " << error.what() << '\n';
    return 2;
  }
}
