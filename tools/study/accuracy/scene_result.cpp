#include "study/accuracy/scene_result.hpp"

#include <functional>

#include <fmt/format.h>

#include "accuracy/accuracy_json.hpp"
#include "measure/in_turn.hpp"
#include "setup/json_text.hpp"
#include "study/accuracy/play.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::Accuracy;
using accuracy::TruthKind;

ConfigurationResult check(const Configuration& configuration, const KnownScene& scene, const AccuracySize& size) {
  ConfigurationResult result;
  result.name = configuration.name;
  accuracy::PairsOfEvents reported;
  std::vector<accuracy::AccuracyTally> tallies(scene.truths.size());
  std::size_t step = 0;
  const Play played = play(configuration, scene, [&](const Events<SceneKey>& events) {
    const std::vector<ScenePair>& pairs = reported.step(events);
    if (pairs.size() > size.most_pairs) {
      result.given_up = fmt::format("{} pairs in step {}", pairs.size(), step);
      return false;
    }
    for (std::size_t i = 0; i < tallies.size(); ++i) tallies[i].step(scene.truths[i].pairs[step], pairs);
    ++step;
    return true;
  });
  if (!result.given_up.empty()) return result;
  result.violations = played.report.violations;
  for (const accuracy::AccuracyTally& tally : tallies) result.accuracies.push_back(tally.result());
  const Accuracy& any = result.accuracies.front();
  result.candidates = static_cast<double>(any.reported_pairs) / static_cast<double>(any.steps);
  return result;
}

nlohmann::json configuration_json(const ConfigurationResult& result) {
  nlohmann::json accuracies = nlohmann::json::array();
  for (const Accuracy& one : result.accuracies) accuracies.emplace_back(accuracy_json(one));
  return {{"name", result.name},
          {"given_up", result.given_up},
          {"step_ms", result.step_ms},
          {"violations", result.violations},
          {"candidates", result.candidates},
          {"accuracies", accuracies}};
}

accuracy::DelayCounts delays_of(const nlohmann::json& json) {
  accuracy::DelayCounts delays;
  for (const nlohmann::json& event : member_of<nlohmann::json>(json, "events"))
    delays.events[event.at(0)] = event.at(1);
  return delays;
}

Accuracy accuracy_of(const nlohmann::json& json) {
  Accuracy result;
  get_member(json, "steps", result.steps);
  get_member(json, "true_pairs", result.true_pairs);
  get_member(json, "reported_pairs", result.reported_pairs);
  get_member(json, "missed_pairs", result.missed_pairs);
  get_member(json, "extra_pairs", result.extra_pairs);
  get_member(json, "true_contacts", result.true_contacts);
  get_member(json, "reported_contacts", result.reported_contacts);
  get_member(json, "answered_contacts", result.answered_contacts);
  result.begins = delays_of(member_of<nlohmann::json>(json, "begins"));
  result.ends = delays_of(member_of<nlohmann::json>(json, "ends"));
  get_member(json, "true_flicker", result.true_flicker);
  get_member(json, "reported_flicker", result.reported_flicker);
  return result;
}

ConfigurationResult configuration_of(const nlohmann::json& json) {
  ConfigurationResult result;
  get_member(json, "name", result.name);
  get_member(json, "given_up", result.given_up);
  get_member(json, "step_ms", result.step_ms);
  get_member(json, "violations", result.violations);
  get_member(json, "candidates", result.candidates);
  for (const nlohmann::json& one : member_of<nlohmann::json>(json, "accuracies"))
    result.accuracies.push_back(accuracy_of(one));
  return result;
}

}  // namespace

AccuracySize AccuracySize::of(bool quick) {
  AccuracySize size;
  if (quick) size = {3000, 16, 200, 3, 1000000};
  return size;
}

std::string truth_name(TruthKind kind) { return fmt::format("T{}", static_cast<int>(kind)); }

SceneResult measure_scene(const KnownScene& scene, const AccuracySize& size) {
  SceneResult result{scene.info.name, scene.objects, scene.steps.size() - 1, scene.width, {}, {}};
  for (const KnownTruth& truth : scene.truths) result.truths.push_back(truth.kind);
  std::vector<std::function<double()>> contenders;
  for (const Configuration& configuration : configurations()) {
    result.configurations.push_back(check(configuration, scene, size));
    if (!result.configurations.back().given_up.empty()) continue;
    contenders.emplace_back(
        [&] { return play(configuration, scene, [](const Events<SceneKey>&) { return true; }).step_ms; });
  }
  auto samples = measure_in_turn(size.rounds, contenders);
  auto next = samples.begin();
  for (ConfigurationResult& one : result.configurations) {
    if (one.given_up.empty()) one.step_ms = std::move(*next++);
  }
  return result;
}

std::vector<std::string> broken_promises(const SceneResult& result) {
  std::vector<std::string> broken;
  for (const ConfigurationResult& one : result.configurations) {
    for (std::size_t i = 0; i < one.accuracies.size(); ++i) {
      const Accuracy& accuracy = one.accuracies[i];
      const Guarantee promised = guarantee(find_configuration(one.name), result.truths[i], one.violations);
      const bool missed = promised != Guarantee::kMayMiss && accuracy.missed_pairs > 0;
      const bool extra = promised == Guarantee::kExact && accuracy.extra_pairs > 0;
      if (!missed && !extra) continue;
      broken.push_back(fmt::format("{}: \"{}\" promises {} of {}, but missed {} pairs and reported {} that are none",
                                   result.name, one.name,
                                   promised == Guarantee::kExact ? "exactly the pairs" : "a superset",
                                   truth_name(result.truths[i]), accuracy.missed_pairs, accuracy.extra_pairs));
    }
  }
  return broken;
}

nlohmann::json scene_result_json(const SceneResult& result) {
  nlohmann::json all = nlohmann::json::array();
  for (const ConfigurationResult& one : result.configurations) all.push_back(configuration_json(one));
  std::vector<int> truths;
  truths.reserve(result.truths.size());
  for (const TruthKind kind : result.truths) truths.push_back(static_cast<int>(kind));
  return {{"name", result.name},   {"objects", result.objects}, {"steps", result.steps},
          {"width", result.width}, {"truths", truths},          {"configurations", all}};
}

SceneResult scene_result_of(const nlohmann::json& json) {
  SceneResult result;
  get_member(json, "name", result.name);
  get_member(json, "objects", result.objects);
  get_member(json, "steps", result.steps);
  get_member(json, "width", result.width);
  for (const int kind : member_of<std::vector<int>>(json, "truths")) {
    result.truths.push_back(static_cast<TruthKind>(kind));
  }
  for (const nlohmann::json& one : member_of<nlohmann::json>(json, "configurations"))
    result.configurations.push_back(configuration_of(one));
  return result;
}

}  // namespace sweepgrid::study
