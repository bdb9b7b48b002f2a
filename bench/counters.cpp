// The guard of performance: what the engine does, counted exactly, against what it did when somebody last looked.
// README.md says when a difference is legitimate.
#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "counter_table.hpp"
#include "engine_setting.hpp"
#include "standard_scenes.hpp"
#include "system.hpp"

namespace sweepgrid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kObjects = 4000;
constexpr std::uint64_t kSteps = 10;
constexpr const char* kSettings[] = {"engine", "rows", "batch", "segmented-counts"};
constexpr double kExact = 0;
// Bytes are those of containers, and how they grow is the standard library's affair.
constexpr double kBytesTolerance = 0.05;

Json to_json(const std::vector<NamedCount>& counts) {
  Json json = Json::object();
  for (const auto& [name, count] : counts) json[name] = count;
  return json;
}

/// What an engine did over a script. The start stands apart from the steps after it: it would hide changes of theirs.
Json work_of(const std::string& setting, int threads, const SceneScript& script) {
  auto config = engine_setting(setting).value();
  config.threads = threads;
  EngineSystem system(config, false, script.objects);
  StepCounters start;
  StepCounters steps;
  for (const ScriptStep& step : script.steps) {
    system.queue(step);
    system.step();
    (&step == &script.steps.front() ? start : steps) += system.engine().stats().step;
  }
  const Stats stats = system.engine().stats();
  return {{"start", to_json(named_counts(start))},
          {"steps", to_json(named_counts(steps))},
          {"pairs", stats.pairs},
          {"bytes", to_json(named_bytes(stats))}};
}

/// By scene and setting.
Json measure(int threads) {
  Json json = Json::object();
  for (const NamedScene& scene : small_scenes(kObjects, kSteps)) {
    const SceneScript script = read_script(scene.scene, kSteps);
    for (const char* setting : kSettings) json[scene.name][setting] = work_of(setting, threads, script);
  }
  return json;
}

std::string change(double old_value, double value) {
  const std::string percent = old_value == 0 ? "" : fmt::format(" ({:+.2f} %)", 100 * (value - old_value) / old_value);
  return fmt::format("{:.0f} -> {:.0f}{}", old_value, value, percent);
}

/// A line on stdout for every count that differs; how many there are. `bytes_tolerance`: a part of the old value.
int print_differences(const Json& old_work, const Json& new_work, double bytes_tolerance) {
  const Json old_counts = old_work.flatten();  // "/scene/setting/steps/swaps": 123
  const Json new_counts = new_work.flatten();
  int differences = 0;
  const auto print = [&](const std::string& path, const std::string& text) {
    fmt::print("  {}: {}\n", path, text);
    ++differences;
  };
  for (const auto& [path, count] : old_counts.items()) {
    if (!new_counts.contains(path)) print(path, count.dump() + " -> gone");
  }
  for (const auto& [path, count] : new_counts.items()) {
    if (!old_counts.contains(path)) {
      print(path, "new -> " + count.dump());
      continue;
    }
    const auto value = count.get<double>();
    const auto old_value = old_counts[path].get<double>();
    const double tolerance = path.find("/bytes/") == std::string::npos ? kExact : bytes_tolerance;
    if (value != old_value && std::abs(value - old_value) > tolerance * old_value)
      print(path, change(old_value, value));
  }
  return differences;
}

Json read_baseline(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read; --update makes it");
  return Json::parse(in);
}

void write_baseline(const std::string& file, const Json& work) {
  std::ofstream out(file);
  out << work.dump(1) << '\n';
  if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

int run(int argc, char** argv) {
  CLI::App app(
      "Counts what the engine does in small scenes, on one thread and on four, and compares it with a baseline. The "
      "exit status is 1 when anything differs, by more than 5 % for bytes.");
  std::string baseline = SWEEPGRID_COUNTERS_BASELINE;
  bool update = false;
  app.add_option("--baseline", baseline, "The counts to compare with")->capture_default_str();
  app.add_flag("--update", update, "Write the counts there instead");
  CLI11_PARSE(app, argc, argv);

  const Json work = measure(1);
  // Every worker has buffers of its own, so bytes may be any.
  fmt::print("one thread -> four threads\n");
  const int between_threads = print_differences(work, measure(4), HUGE_VAL);
  fmt::print("  {} differences\n", between_threads);
  if (between_threads > 0) return 1;
  if (update) {
    write_baseline(baseline, work);
    return 0;
  }
  fmt::print("{} -> now\n", baseline);
  const int since_baseline = print_differences(read_baseline(baseline), work, kBytesTolerance);
  fmt::print("  {} differences\n", since_baseline);
  return since_baseline == 0 ? 0 : 1;
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  try {
    return sweepgrid::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "counters: " << error.what() << '\n';
    return 2;
  }
}
