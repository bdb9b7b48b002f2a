// What envelopes cost and save: envelopes SCENE [ROUNDS] [THREADS] plays the scene with every setting in turn, round by
// round, and prints medians over the rounds: of the time per step (queueing calls and step()), and its ratio to no
// envelopes in the same round.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/sap/rounding.hpp>

#include "measure/in_turn.hpp"
#include "measure/stopwatch.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid::bench {
namespace {

using SceneEngine = Engine<float, 3>;

/// A step of the scene as the engine takes it.
struct Step {
  SceneStep scene;
  std::vector<Box<float, 3>> inserted_boxes;
  std::vector<Box<float, 3>> updated_boxes;
};

struct Setting {
  std::string name;
  std::optional<EnvelopeOptions> options;
};

struct Outcome {
  double seconds = 0;
  Stats stats;
  EnvelopeReport report;
  std::size_t most_candidates = 0;  // after any step
};

std::vector<Box<float, 3>> rounded(const std::vector<SceneBox>& boxes) {
  std::vector<Box<float, 3>> result;
  for (const SceneBox& box : boxes) result.push_back(round_outward<float>(box));
  return result;
}

Outcome play(const std::vector<Step>& steps, const Setting& setting, int threads) {
  Config config;
  config.threads = threads;
  config.envelope = setting.options;
  SceneEngine engine(config);
  std::unordered_map<SceneKey, Handle> handles;
  Outcome outcome;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SceneStep& step = steps[i].scene;
    std::vector<Handle> erased;
    std::vector<Handle> updated;
    for (const SceneKey key : step.erased) erased.push_back(handles.at(key));
    for (const SceneKey key : step.updated) updated.push_back(handles.at(key));
    const WallStopwatch watch;
    engine.erase(erased);
    const std::vector<Handle> inserted = engine.insert(step.inserted, steps[i].inserted_boxes);
    engine.update(updated, steps[i].updated_boxes);
    engine.step();
    if (i > 0) outcome.seconds += watch.seconds();
    outcome.most_candidates = std::max(outcome.most_candidates, engine.envelope_report().candidates);
    for (std::size_t k = 0; k < inserted.size(); ++k) handles[step.inserted[k]] = inserted[k];
  }
  outcome.seconds /= static_cast<double>(steps.size() - 1);
  outcome.stats = engine.stats();
  outcome.report = engine.envelope_report();
  return outcome;
}

double width_of(const SceneStep& start) {
  std::vector<double> widths;
  for (const SceneBox& box : start.inserted_boxes) widths.push_back(box.max[0] - box.min[0]);
  std::nth_element(widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2), widths.end());
  return widths[widths.size() / 2];
}

std::vector<Setting> settings_for(double width) {
  std::vector<Setting> settings{{"none", {}}, {"envelopes are the boxes", EnvelopeOptions{}}};
  for (const double share : {0.02, 0.05, 0.1, 0.2}) {
    const std::string name = "margin " + std::to_string(share).substr(0, 4) + " widths";
    settings.push_back({name, EnvelopeOptions{.margin = share * width}});
    settings.push_back({name + ", exact", EnvelopeOptions{.margin = share * width, .exact = true}});
  }
  settings.push_back({"swept", EnvelopeOptions{.swept = true}});
  settings.push_back({"stride 4", EnvelopeOptions{.stride = 4}});
  settings.push_back({"stride 4, margin 0.2", EnvelopeOptions{.margin = 0.2 * width, .stride = 4}});
  settings.push_back({"stride 4, margin 0.2, queries",
                      EnvelopeOptions{.margin = 0.2 * width, .stride = 4, .on_violation = OnViolation::kQuery}});
  settings.push_back(
      {"stride 4, margin 0.2, queries, exact",
       EnvelopeOptions{.margin = 0.2 * width, .stride = 4, .on_violation = OnViolation::kQuery, .exact = true}});
  // Of steps: as wide as ACCURACY.md asks for.
  settings.push_back({"margin 2 steps", EnvelopeOptions{.margin_steps = 2}});
  settings.push_back({"stride 4, margin 6 steps", EnvelopeOptions{.margin_steps = 6, .stride = 4}});
  settings.push_back({"stride 4, margin 6 steps, queries",
                      EnvelopeOptions{.margin_steps = 6, .stride = 4, .on_violation = OnViolation::kQuery}});
  settings.push_back(
      {"stride 4, margin 6 steps, queries, exact",
       EnvelopeOptions{.margin_steps = 6, .stride = 4, .on_violation = OnViolation::kQuery, .exact = true}});
  return settings;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void run(const std::string& spec, int rounds, int threads) {
  std::vector<Step> steps;
  const auto scene = open_scene(spec);
  for (Step step; scene->next(step.scene);) {
    step.inserted_boxes = rounded(step.scene.inserted_boxes);
    step.updated_boxes = rounded(step.scene.updated_boxes);
    steps.push_back(step);
  }
  const std::vector<Setting> settings = settings_for(width_of(steps.at(0).scene));
  std::vector<std::vector<double>> seconds(settings.size());
  std::vector<std::vector<double>> ratios(settings.size());
  std::vector<Outcome> outcomes(settings.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t s = 0; s < settings.size(); ++s) {
      outcomes[s] = play(steps, settings[s], threads);
      seconds[s].push_back(outcomes[s].seconds);
      ratios[s].push_back(seconds[0].back() / outcomes[s].seconds);
    }
  }
  std::printf(
      "| %-40s | us per step | times faster | updates per step | queries | events | pairs at the end | most candidates "
      "| outside |\n",
      "");
  for (std::size_t s = 0; s < settings.size(); ++s) {
    const Stats& stats = outcomes[s].stats;
    std::printf("| %-40s | %11.1f | %12.2f | %16.1f | %7llu | %6llu | %16zu | %15zu | %7llu |\n",
                settings[s].name.c_str(), 1e6 * median(seconds[s]), median(ratios[s]),
                static_cast<double>(stats.total.updates) / static_cast<double>(steps.size() - 1),
                static_cast<unsigned long long>(outcomes[s].report.queries),
                static_cast<unsigned long long>(stats.total.begins + stats.total.ends), stats.pairs,
                outcomes[s].most_candidates, static_cast<unsigned long long>(outcomes[s].report.violations));
  }
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::invalid_argument("usage: envelopes SCENE [ROUNDS] [THREADS]");
    sweepgrid::bench::run(argv[1], argc > 2 ? std::stoi(argv[2]) : 9, argc > 3 ? std::stoi(argv[3]) : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
