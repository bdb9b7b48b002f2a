// The engine in several settings and its peers, in turn on the same scenes: what a step costs, and what it costs
// relative to the first system. `compare --help` tells the rest.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "comparison_report.hpp"
#include "contestants.hpp"
#include "engine_setting.hpp"
#include "figures_file.hpp"
#include "rounds.hpp"
#include "standard_scenes.hpp"

namespace sweepgrid::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> scenes;
  bool large = false;
  std::string recordings;
  std::vector<std::string> systems;
  EngineOptions engine;
  bool all_sizes = false;
  int rounds = 3;
  std::uint64_t steps = 50;
  std::string json;
};

// Bullet first, as the one that all ratios are of; then the engine, then the other peers.
std::vector<std::string> default_systems() {
  std::vector<std::string> names = {"engine", "engine2", "segmented"};
  for (const Contestant& peer : peers()) {
    names.insert(peer.name == "bullet" ? names.begin() : names.end(), peer.name);
  }
  return names;
}

std::string systems_help() {
  std::string text = "Systems:\n  " + engine_setting_help() + ": the engine, as it comes or with other cells, " +
                     "another reduction, more threads than one\n";
  for (const Contestant& peer : peers()) text += fmt::format("  {}: {}\n", peer.name, peer.about);
  return text;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("scenes", options.scenes,
                 "Recordings or generators, as `sweepgrid run` takes them; the standard scenes when absent");
  app.add_flag("--large", options.large, "The scenes of up to 1e6 objects as well");
  app.add_option("--recordings", options.recordings,
                 "The recordings in this folder as well; with the standard scenes, those of the repository when absent")
      ->check(CLI::ExistingDirectory);
  app.add_option("--systems", options.systems, "What runs; ratios are to the first")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_flag("--all-sizes", options.all_sizes, "Run peers in scenes, too, where they take minutes");
  app.add_option("--rounds", options.rounds, "Times that all systems run in turn")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", options.steps, "Steps of a scene, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--population", options.engine.population, "Objects per cell of the engine's grid");
  app.add_option("--segment-capacity", options.engine.segment_capacity, "Endpoints per segment");
  app.add_flag("--single-calls", options.engine.single_calls, "Tell the engine of one object at a time, not in bulk");
  app.add_option("--json", options.json, "Also write the figures here");
  app.footer(systems_help);
}

std::vector<NamedScene> chosen_scenes(const Options& options) {
  std::vector<NamedScene> scenes;
  for (const std::string& scene : options.scenes) scenes.push_back({scene, scene});
  if (scenes.empty()) {
    scenes = standard_scenes();
    if (options.recordings.empty()) std::ranges::copy(recordings(SWEEPGRID_RECORDINGS), std::back_inserter(scenes));
  }
  if (options.large) std::ranges::copy(large_scenes(), std::back_inserter(scenes));
  if (!options.recordings.empty()) std::ranges::copy(recordings(options.recordings), std::back_inserter(scenes));
  return scenes;
}

std::vector<Contestant> chosen_contestants(const Options& options) {
  std::vector<Contestant> contestants;
  for (const std::string& name : options.systems) {
    const auto found = find_contestant(name, options.engine);
    if (!found) throw CLI::ValidationError("--systems", "there is no system '" + name + "' in this build");
    contestants.push_back(*found);
  }
  return contestants;
}

/// Prints the scene's table and adds its figures to `json`; false when a system is wrong.
bool compare(const NamedScene& scene, const std::vector<Contestant>& contestants, const Options& options, Json& json) {
  const SceneScript script = read_script(scene.scene, options.steps);
  fmt::print("{}\n", scene.name == scene.scene ? scene.name : fmt::format("{} ({})", scene.name, scene.scene));
  std::vector<Contestant> chosen;
  std::vector<std::string> skipped;
  for (const Contestant& contestant : contestants) {
    if (options.all_sizes || script.objects <= contestant.most_objects) {
      chosen.push_back(contestant);
    } else {
      skipped.push_back(contestant.name);
    }
  }
  bool right = true;
  Json systems = Json::array();
  if (!chosen.empty()) {
    const Rounds rounds(chosen, script, options.rounds);
    print_table(rounds);
    systems = to_json(rounds);
    for (std::size_t i = 0; i < rounds.size(); ++i) right = right && rounds.complaints(i).empty();
  }
  for (const std::string& name : skipped) fmt::print("  {}: skipped for its time here; --all-sizes runs it\n", name);
  std::fflush(stdout);
  json.push_back({{"name", scene.name},
                  {"scene", scene.scene},
                  {"objects", script.live},
                  {"steps", script.steps.size() - 1},
                  {"systems", systems},
                  {"skipped", skipped}});
  return right;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Times broad phases in turn on the same scenes. A ratio is of the same round; its median and range over the "
      "rounds are told. The pairs that each system finds are checked; the exit status is 1 when a system is wrong.");
  Options options;
  options.systems = default_systems();
  add_options(app, options);
  std::vector<Contestant> contestants;
  try {
    app.parse(argc, argv);
    contestants = chosen_contestants(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  bool right = true;
  Json scenes = Json::array();
  for (const NamedScene& scene : chosen_scenes(options)) right = compare(scene, contestants, options, scenes) && right;
  if (!options.json.empty()) {
    write_figures(options.json, "sweepgrid-compare",
                  {{"rounds", options.rounds}, {"single_calls", options.engine.single_calls}, {"scenes", scenes}});
  }
  return right ? 0 : 1;
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
