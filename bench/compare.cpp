// The engine in several settings and its peers, in turn on the same scene: what a step costs, and what it costs
// relative to the first system. `compare --help` tells the rest.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene_script.hpp"
#include "system.hpp"

namespace sweepgrid::bench {
namespace {

using Maker = std::function<std::unique_ptr<System>(std::uint32_t objects)>;

/// What one run of one system over one scene gave.
struct Run {
  double first_insert_seconds = 0;
  double ns_per_update = 0;      // whole steps, queueing included, by moved, inserted and erased objects
  double step_only_seconds = 0;  // sum over steps
  double p99_over_mean = 0;      // of the steps' times
  std::uint64_t pairs = 0;
  std::uint64_t begins = 0;
  std::uint64_t ends = 0;
  double bytes_per_object = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

Run run_once(const Maker& maker, const SceneScript& script) {
  const auto system = maker(script.objects);
  Run run;
  std::vector<double> times;
  double sum = 0;
  double moved = 0;
  for (const ScriptStep& step : script.steps) {
    const auto start = std::chrono::steady_clock::now();
    system->step(step);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (&step == &script.steps.front()) {
      run.first_insert_seconds = seconds;
      continue;
    }
    times.push_back(seconds);
    sum += seconds;
    run.step_only_seconds += system->step_only_seconds();
    moved += static_cast<double>(step.updated.size() + step.inserted.size() + step.erased.size());
  }
  run.ns_per_update = moved > 0 ? sum / moved * 1e9 : 0;
  std::sort(times.begin(), times.end());
  if (sum > 0) run.p99_over_mean = times[times.size() * 99 / 100] / (sum / static_cast<double>(times.size()));
  run.pairs = system->pairs();
  run.begins = system->begins();
  run.ends = system->ends();
  run.bytes_per_object = static_cast<double>(system->bytes()) / script.objects;
  return run;
}

std::map<std::string, Maker> makers(int population, int segment_capacity) {
  std::map<std::string, Maker> makers;
  const std::map<std::string, CellKind> kinds = {{"batch", CellKind::kBatch},
                                                 {"segmented", CellKind::kSegmented},
                                                 {"classic", CellKind::kClassic},
                                                 {"plane", CellKind::kPlane}};
  for (const auto& [name, kind] : kinds) {
    for (const int threads : {1, 2, 4, 8}) {
      Config<float, 3> config;
      config.cell.kind = kind;
      config.cell.segment_capacity = segment_capacity;
      config.cell_population = population;
      config.threads = threads;
      makers[threads == 1 ? name : name + std::to_string(threads)] = [config](std::uint32_t objects) {
        return make_engine(config, objects);
      };
    }
  }
#ifdef SWEEPGRID_WITH_BULLET
  makers["bullet"] = make_bullet;
#endif
  return makers;
}

/// Runs all systems in turn `rounds` times and prints a row for each; false when they disagree on the pairs.
bool compare(const SceneScript& script, const std::vector<std::string>& names,
             const std::map<std::string, Maker>& systems, int rounds, nlohmann::json& json) {
  std::map<std::string, std::vector<Run>> runs;
  for (int round = 0; round < rounds; ++round) {
    for (const std::string& name : names) runs[name].push_back(run_once(systems.at(name), script));
  }
  fmt::print("{}\n  {:<12} {:>10} {:>18} {:>20} {:>9} {:>10} {:>9} {:>10} {:>8}\n", script.name, "system", "ns/update",
             fmt::format("x faster, of {}", names[0]), "step only, x faster", "p99/mean", "insert ms", "pairs",
             "begins", "bytes/ob");
  bool agree = true;
  for (const std::string& name : names) {
    const auto column = [&](auto&& figure) {
      std::vector<double> values;
      for (std::size_t i = 0; i < runs[name].size(); ++i) values.push_back(figure(runs[name][i], runs[names[0]][i]));
      return values;
    };
    const auto ratios = column([](const Run& a, const Run& b) { return b.ns_per_update / a.ns_per_update; });
    const auto step_ratios =
        column([](const Run& a, const Run& b) { return b.step_only_seconds / a.step_only_seconds; });
    const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
    const double ns = median(column([](const Run& a, const Run&) { return a.ns_per_update; }));
    const double p99 = median(column([](const Run& a, const Run&) { return a.p99_over_mean; }));
    const double first = median(column([](const Run& a, const Run&) { return a.first_insert_seconds * 1e3; }));
    const Run& last = runs[name].back();
    agree = agree && last.pairs == runs[names[0]].back().pairs;
    fmt::print("  {:<12} {:>10.1f} {:>6.2f} ({:.2f}-{:.2f}) {:>20.2f} {:>9.2f} {:>10.1f} {:>9} {:>10} {:>8.0f}\n", name,
               ns, median(ratios), *low, *high, median(step_ratios), p99, first, last.pairs, last.begins,
               last.bytes_per_object);
    json.push_back({{"scene", script.name},
                    {"system", name},
                    {"baseline", names[0]},
                    {"rounds", rounds},
                    {"ns_per_update", ns},
                    {"times_faster", median(ratios)},
                    {"times_faster_min", *low},
                    {"times_faster_max", *high},
                    {"step_only_times_faster", median(step_ratios)},
                    {"p99_over_mean", p99},
                    {"first_insert_ms", first},
                    {"pairs", last.pairs},
                    {"begins", last.begins},
                    {"ends", last.ends},
                    {"bytes_per_object", last.bytes_per_object}});
  }
  if (!agree) fmt::print("  the systems disagree on the number of pairs\n");
  std::cout.flush();
  return agree;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Times broad phases in turn on the same scenes. A ratio is of whole steps in the same round; its median "
      "and range over the rounds are told.");
  std::vector<std::string> scenes = {"uniform:n=100000,moving=0.1,churn=0", "uniform:n=100000,moving=1,churn=0",
                                     "uniform:n=100000,moving=0.1,churn=0.005"};
#ifdef SWEEPGRID_WITH_BULLET
  std::vector<std::string> names = {"bullet", "batch", "segmented"};
#else
  std::vector<std::string> names = {"batch", "segmented"};
#endif
  int rounds = 3;
  std::uint64_t steps = 50;
  int population = Config<float, 3>{}.cell_population;
  int segment_capacity = CellOptions{}.segment_capacity;
  std::string json_file;
  app.add_option("scenes", scenes, "Recordings or generators, as `sweepgrid run` takes them")->capture_default_str();
  app.add_option("--systems", names,
                 "bullet (if built in), batch, segmented, classic, plane; batch2: on 2 threads. "
                 "Ratios are to the first")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Times that all systems run in turn")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", steps, "Steps of each scene")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--population", population, "Objects per cell")->capture_default_str();
  app.add_option("--segment-capacity", segment_capacity, "Endpoints per segment")->capture_default_str();
  app.add_option("--json", json_file, "Also write the figures here");
  CLI11_PARSE(app, argc, argv);

  const auto systems = makers(population, segment_capacity);
  for (const std::string& name : names) {
    if (systems.contains(name)) continue;
    std::cerr << "compare: --systems: there is no system '" << name << "' in this build\n";
    return 2;
  }
  bool agree = true;
  nlohmann::json json = nlohmann::json::array();
  for (const std::string& scene : scenes)
    agree = compare(read_script(scene, steps), names, systems, rounds, json) && agree;
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(2) << '\n';
  return agree ? 0 : 1;
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  try {
    return sweepgrid::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "compare: " << error.what() << '\n';
    return 2;
  }
}
