#include "accuracy/method_trial.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "accuracy/truth.hpp"
#include "measure/stopwatch.hpp"
#include "setup/json_text.hpp"

namespace sweepgrid::accuracy {
namespace {

constexpr std::array<std::pair<Verdict, std::string_view>, 9> kVerdicts = {{{Verdict::kCrash, "crash"},
                                                                            {Verdict::kError, "error"},
                                                                            {Verdict::kOutOfMemory, "memory"},
                                                                            {Verdict::kOutOfTime, "time"},
                                                                            {Verdict::kOverBudget, "budget"},
                                                                            {Verdict::kTakesBad, "bad"},
                                                                            {Verdict::kMisses, "misses"},
                                                                            {Verdict::kSuperset, "superset"},
                                                                            {Verdict::kExact, "exact"}}};

// Takes updates to bad boxes out of `step`.
ScriptStep take_bad(ScriptStep& step) {
  ScriptStep bad;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < step.updated.size(); ++i) {
    const bool good = step.updated_boxes[i].valid();
    if (!good) {
      bad.updated.push_back(step.updated[i]);
      bad.updated_boxes.push_back(step.updated_boxes[i]);
      continue;
    }
    step.updated[kept] = step.updated[i];
    step.updated_boxes[kept++] = step.updated_boxes[i];
  }
  step.updated.resize(kept);
  step.updated_boxes.resize(kept);
  return bad;
}

std::vector<ScenePair> sorted_pairs(const baselines::System& system) {
  std::vector<ScenePair> pairs;
  for (const auto& [a, b] : system.pairs()) pairs.push_back({std::min(a, b), std::max(a, b)});
  if (!std::is_sorted(pairs.begin(), pairs.end(), ScenePairOrder())) {
    std::sort(pairs.begin(), pairs.end(), ScenePairOrder());
  }
  return pairs;
}

std::uint64_t count_without(const std::vector<ScenePair>& all, const std::vector<ScenePair>& some) {
  std::vector<ScenePair> rest;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(rest), ScenePairOrder());
  return rest.size();
}

/// One method on its way through one script.
class Play {
 public:
  Play(const Method& method, const KnownScript& known) : method_(method), known_(known) {}

  Trial run(double seconds, std::uint64_t bytes) {
    double spent_ms = 0;
    const auto system = method_.make(known_.script, bytes);
    std::vector<double> times;
    for (std::size_t i = 0; i < known_.script.steps.size(); ++i) {
      const double ms = 1e3 * step(*system, known_.script.steps[i]);
      spent_ms += ms;
      if (system->refused()) {
        judge_refusal(*system, i);
        break;
      }
      compare(sorted_pairs(*system), known_.pairs[i]);
      if (i == 0) {
        trial_.start_ms = ms;
      } else {
        times.push_back(ms);
      }
      if (spent_ms < 1e3 * seconds || i + 1 == known_.script.steps.size()) continue;
      trial_.verdict = Verdict::kOutOfTime;
      break;
    }
    trial_.steps = times.size();
    if (!times.empty()) {
      std::sort(times.begin(), times.end());
      trial_.step_ms = times[times.size() / 2];
      trial_.most_step_ms = times.back();
    }
    if (trial_.verdict == Verdict::kExact) judge();
    return trial_;
  }

 private:
  // Seconds. A method that refuses bad input is given that first, box by box, which is not timed.
  double step(baselines::System& system, const ScriptStep& changes) {
    ScriptStep good = changes;
    if (method_.refuses_bad_input) offer(system, take_bad(good));
    const ThreadStopwatch time;
    system.queue(good);
    system.step();
    return time.seconds();
  }

  void offer(baselines::System& system, const ScriptStep& bad) {
    for (std::size_t i = 0; i < bad.updated.size(); ++i) {
      ScriptStep one;
      one.updated = {bad.updated[i]};
      one.updated_boxes = {bad.updated_boxes[i]};
      try {
        system.queue(one);
      } catch (const std::invalid_argument&) {
        ++trial_.refused_boxes;
      }
    }
  }

  void compare(const std::vector<ScenePair>& reported, const std::vector<ScenePair>& truth) {
    trial_.true_pairs += truth.size();
    trial_.reported_pairs += reported.size();
    trial_.missed_pairs += count_without(truth, reported);
    trial_.extra_pairs += count_without(reported, truth);
  }

  // A refused step must have left nothing behind.
  void judge_refusal(const baselines::System& system, std::size_t step) {
    const std::vector<ScenePair> before = step == 0 ? std::vector<ScenePair>() : known_.pairs[step - 1];
    trial_.verdict = Verdict::kOverBudget;
    if (sorted_pairs(system) == before) return;
    trial_.verdict = Verdict::kError;
    trial_.error = "a refused step has left something behind";
  }

  void judge() {
    if (trial_.refused_boxes < known_.bad_boxes) {
      trial_.verdict = Verdict::kTakesBad;
    } else if (trial_.missed_pairs > 0) {
      trial_.verdict = Verdict::kMisses;
    } else if (trial_.extra_pairs > 0) {
      trial_.verdict = Verdict::kSuperset;
    }
  }

  const Method& method_;
  const KnownScript& known_;
  Trial trial_;
};

Verdict verdict_of(RunEnd end) {
  switch (end) {
    case RunEnd::kOutOfMemory:
      return Verdict::kOutOfMemory;
    case RunEnd::kOutOfTime:
      return Verdict::kOutOfTime;
    case RunEnd::kError:
      return Verdict::kError;
    default:
      return Verdict::kCrash;
  }
}

}  // namespace

KnownScript know_script(const std::string& scene, std::uint64_t steps) {
  KnownScript known;
  known.script = read_script(scene, steps);
  const auto truth = make_truth(TruthKind::kInstants, {});
  for (const ScriptStep& step : known.script.steps) {
    ScriptStep good = step;
    known.bad_boxes += take_bad(good).updated.size();
    known.pairs.push_back(truth->step(scene_step(good)));
  }
  return known;
}

std::string verdict_name(Verdict verdict) {
  const auto known = std::find_if(kVerdicts.begin(), kVerdicts.end(),
                                  [verdict](const auto& candidate) { return candidate.first == verdict; });
  return std::string(known->second);
}

Trial try_method(const Method& method, const KnownScript& known, const RunBudget& budget) {
  const RunBudget whole{budget.bytes, 4 * budget.seconds};
  const GuardedRun run =
      run_guarded(whole, [&] { return trial_json(Play(method, known).run(budget.seconds / 2, budget.bytes)).dump(); });
  Trial trial;
  if (run.end == RunEnd::kDone) {
    trial = trial_of(nlohmann::json::parse(run.text));
  } else {
    trial.verdict = verdict_of(run.end);
    trial.error = run.text;
  }
  trial.peak_bytes = run.peak_bytes;
  return trial;
}

nlohmann::json trial_json(const Trial& trial) {
  return {{"verdict", verdict_name(trial.verdict)},
          {"error", trial.error},
          {"steps", trial.steps},
          {"true_pairs", trial.true_pairs},
          {"reported_pairs", trial.reported_pairs},
          {"missed_pairs", trial.missed_pairs},
          {"extra_pairs", trial.extra_pairs},
          {"refused_boxes", trial.refused_boxes},
          {"start_ms", trial.start_ms},
          {"step_ms", trial.step_ms},
          {"most_step_ms", trial.most_step_ms},
          {"peak_bytes", trial.peak_bytes}};
}

Trial trial_of(const nlohmann::json& json) {
  Trial trial;
  const auto name = member_of<std::string>(json, "verdict");
  const auto verdict =
      std::find_if(kVerdicts.begin(), kVerdicts.end(), [&](const auto& known) { return known.second == name; });
  if (verdict == kVerdicts.end()) throw std::invalid_argument("no verdict '" + name + "'");
  trial.verdict = verdict->first;
  get_member(json, "error", trial.error);
  get_member(json, "steps", trial.steps);
  get_member(json, "true_pairs", trial.true_pairs);
  get_member(json, "reported_pairs", trial.reported_pairs);
  get_member(json, "missed_pairs", trial.missed_pairs);
  get_member(json, "extra_pairs", trial.extra_pairs);
  get_member(json, "refused_boxes", trial.refused_boxes);
  get_member(json, "start_ms", trial.start_ms);
  get_member(json, "step_ms", trial.step_ms);
  get_member(json, "most_step_ms", trial.most_step_ms);
  get_member(json, "peak_bytes", trial.peak_bytes);
  return trial;
}

}  // namespace sweepgrid::accuracy
