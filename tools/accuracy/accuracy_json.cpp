#include "accuracy/accuracy_json.hpp"

#include <nlohmann/json.hpp>

namespace sweepgrid::accuracy {
namespace {

nlohmann::ordered_json delays_json(const DelayCounts& delays) {
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  for (const auto& [delay, number] : delays.events) events.push_back({delay, number});
  return {{"count", delays.count()},
          {"off_time", delays.off_time()},
          {"mean", delays.mean()},
          {"most", delays.most()},
          {"events", std::move(events)}};
}

}  // namespace

nlohmann::ordered_json accuracy_json(const Accuracy& accuracy) {
  return {{"steps", accuracy.steps},
          {"true_pairs", accuracy.true_pairs},
          {"reported_pairs", accuracy.reported_pairs},
          {"missed_pairs", accuracy.missed_pairs},
          {"extra_pairs", accuracy.extra_pairs},
          {"recall", accuracy.recall()},
          {"precision", accuracy.precision()},
          {"true_contacts", accuracy.true_contacts},
          {"reported_contacts", accuracy.reported_contacts},
          {"answered_contacts", accuracy.answered_contacts},
          {"begins", delays_json(accuracy.begins)},
          {"ends", delays_json(accuracy.ends)},
          {"true_flicker", accuracy.true_flicker},
          {"reported_flicker", accuracy.reported_flicker}};
}

}  // namespace sweepgrid::accuracy
