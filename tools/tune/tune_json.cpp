#include "tune/tune_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "setup/setup_json.hpp"

namespace sweepgrid::tune {
namespace {

using Json = nlohmann::ordered_json;

Json demand_json(const Demand& demand) {
  return {{"truth", truth_name(demand.truth)},
          {"missed", demand.missed},
          {"extra", demand.extra ? Json(*demand.extra) : Json(nullptr)},
          {"narrow_ns", demand.narrow_ns},
          {"narrow_source", demand.narrow_source},
          {"threads", demand.threads}};
}

Json sample_json(const SceneSample& sample, const SceneFacts& facts) {
  Json windows = Json::array();
  for (const Window& window : sample.windows) {
    windows.push_back({{"begin", window.begin}, {"warm_up", window.warm_up}, {"measured", window.measured()}});
  }
  return {{"steps", sample.steps},
          {"windows", windows},
          {"width", sample.width},
          {"objects", facts.objects},
          {"edges", {facts.least_edge, facts.most_edge}},
          {"farthest_widths", facts.farthest},
          {"floats", facts.floats},
          {"updates", facts.updates},
          {"displacement_widths", {{"median", facts.displacement}, {"most", facts.most_displacement}}},
          {"pairs", facts.pairs},
          {"pairs_without_axis", facts.pairs_without}};
}

Json trial_json(const Trial& trial, const Demand& demand) {
  return {{"step_ms", trial.step_ms()},
          {"pairs", trial.candidates()},
          {"total_ms", trial.total_ms(demand.narrow_ns)},
          {"rounds", trial.rounds},
          {"missed_pairs", trial.missed_pairs},
          {"extra_pairs", trial.extra_pairs},
          {"extra", trial.extra()}};
}

Json exhaustive_json(const Tuning& tuning) {
  const ExhaustiveResult& all = *tuning.exhaustive;
  const double narrow_ns = tuning.demand.narrow_ns;
  return {{"candidates", all.measured},
          {"ruled_out", all.ruled_out},
          {"seconds", all.seconds},
          {"times_as_long", all.seconds / tuning.seconds},
          {"best", all.best.name()},
          {"best_trial", trial_json(all.best_trial, tuning.demand)},
          {"chosen_trial", trial_json(all.chosen_trial, tuning.demand)},
          {"chosen_over_best", all.chosen_trial.total_ms(narrow_ns) / all.best_trial.total_ms(narrow_ns)}};
}

}  // namespace

Json tune_json(const Tuning& tuning) {
  const TuneResult& result = tuning.result;
  Json reasons = Json::array();
  for (const Reason& reason : result.reasons) {
    reasons.push_back({{"about", reason.about}, {"choice", reason.choice}, {"because", reason.because}});
  }
  Json rejected = Json::array();
  for (const Rejection& one : result.rejected) {
    rejected.push_back({{"candidate", one.candidate},
                        {"because", one.because},
                        {"rounds", one.rounds},
                        {"total_ms", one.rounds > 0 ? Json(one.total_ms) : Json(nullptr)}});
  }
  Json json = setup_json(result.chosen.setup(tuning.sample, tuning.demand.threads));
  json["tune"] = {{"scene", tuning.scene.name},
                  {"demand", demand_json(tuning.demand)},
                  {"guarantee", guarantee_name(result.guarantee)},
                  {"chosen", result.chosen.name()},
                  {"measured", trial_json(result.trial, tuning.demand)},
                  {"reasons", reasons},
                  {"rejected", rejected},
                  {"sample", sample_json(tuning.sample, tuning.facts)},
                  {"seconds", tuning.seconds}};
  if (tuning.exhaustive) json["tune"]["exhaustive"] = exhaustive_json(tuning);
  return json;
}

std::string tune_text(const Tuning& tuning) {
  const TuneResult& result = tuning.result;
  const double narrow_ns = tuning.demand.narrow_ns;
  std::string text = fmt::format(
      "{}\n  {}\n  chosen: {}\n  {:.4g} ms a step, {:.4g} pairs, {:.4g} ms in total with "
      "{:.4g} ns a pair ({})\n",
      tuning.scene.name, demand_text(tuning.demand), result.chosen.name(), result.trial.step_ms(),
      result.trial.candidates(), result.trial.total_ms(narrow_ns), narrow_ns, tuning.demand.narrow_source);
  for (const Reason& reason : result.reasons) {
    text += fmt::format("  {:<9} {}: {}\n", reason.about, reason.choice, reason.because);
  }
  text += "  rejected\n";
  for (const Rejection& one : result.rejected) text += fmt::format("    {}: {}\n", one.candidate, one.because);
  text += fmt::format("  {} of {} steps measured; {:.2f} s of processor time\n", tuning.sample.measured(),
                      tuning.sample.steps, tuning.seconds);
  if (tuning.exhaustive) {
    const ExhaustiveResult& all = *tuning.exhaustive;
    text += fmt::format(
        "  of {} candidates over all steps ({:.1f} s, {:.0f} times as long), the best: {}, {:.4g} ms; the "
        "chosen one {:.4g} ms, {:.3f} times that\n",
        all.measured, all.seconds, all.seconds / tuning.seconds, all.best.name(), all.best_trial.total_ms(narrow_ns),
        all.chosen_trial.total_ms(narrow_ns),
        all.chosen_trial.total_ms(narrow_ns) / all.best_trial.total_ms(narrow_ns));
  }
  return text;
}

}  // namespace sweepgrid::tune
