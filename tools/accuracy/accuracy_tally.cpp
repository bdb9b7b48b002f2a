#include "accuracy/accuracy_tally.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

namespace sweepgrid::accuracy {
namespace {

const ScenePairOrder kBefore;

std::vector<ScenePair> without(const std::vector<ScenePair>& all, const std::vector<ScenePair>& some) {
  std::vector<ScenePair> rest;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(rest), kBefore);
  return rest;
}

double part(std::uint64_t some, std::uint64_t all) {
  return all == 0 ? 1 : static_cast<double>(some) / static_cast<double>(all);
}

}  // namespace

std::uint64_t DelayCounts::count() const {
  std::uint64_t sum = 0;
  for (const auto& [delay, number] : events) sum += number;
  return sum;
}

std::uint64_t DelayCounts::off_time() const {
  const auto on_time = events.find(0);
  return count() - (on_time == events.end() ? 0 : on_time->second);
}

double DelayCounts::mean() const {
  double sum = 0;
  for (const auto& [delay, number] : events) sum += static_cast<double>(std::abs(delay)) * static_cast<double>(number);
  return events.empty() ? 0 : sum / static_cast<double>(count());
}

std::int64_t DelayCounts::most() const {
  if (events.empty()) return 0;
  const std::int64_t earliest = events.begin()->first;
  const std::int64_t latest = events.rbegin()->first;
  return -earliest > latest ? earliest : latest;
}

double Accuracy::recall() const { return part(true_pairs - missed_pairs, true_pairs); }
double Accuracy::precision() const { return part(reported_pairs - extra_pairs, reported_pairs); }

void AccuracyTally::step(const std::vector<ScenePair>& truth, const std::vector<ScenePair>& reported) {
  result_.true_pairs += truth.size();
  result_.reported_pairs += reported.size();
  result_.missed_pairs += without(truth, reported).size();
  result_.extra_pairs += without(reported, truth).size();
  for (const ScenePair& pair : without(last_truth_, truth)) {
    History& history = histories_[pair];
    end(history, history.truth, history.truth_end);
  }
  for (const ScenePair& pair : without(last_reported_, reported)) {
    History& history = histories_[pair];
    end(history, history.reported, history.reported_end);
  }
  const std::vector<ScenePair> true_begins = without(truth, last_truth_);
  const std::vector<ScenePair> reported_begins = without(reported, last_reported_);
  for (const ScenePair& pair : true_begins) {
    begin(histories_[pair].truth, result_.true_contacts, result_.true_flicker);
  }
  for (const ScenePair& pair : reported_begins) {
    begin(histories_[pair].reported, result_.reported_contacts, result_.reported_flicker);
  }
  for (const ScenePair& pair : true_begins) relate(histories_[pair]);
  for (const ScenePair& pair : reported_begins) relate(histories_[pair]);
  last_truth_ = truth;
  last_reported_ = reported;
  ++step_;
  result_.steps = step_;
  forget_old();
}

void AccuracyTally::begin(Stay& stay, std::uint64_t& contacts, std::uint64_t& flicker) const {
  ++contacts;
  if (stay.ever && step_ - stay.begin <= flicker_steps_) ++flicker;
  stay = {true, true, false, step_};
}

void AccuracyTally::end(History& history, Stay& stay, std::optional<std::uint64_t>& its_end) {
  stay.there = false;
  // Of the open couple, unless that one has ended already and this is a later stay.
  if (!history.open || !stay.answered) return;
  its_end = step_;
  if (!history.truth_end || !history.reported_end) return;
  ++result_.ends
        .events[static_cast<std::int64_t>(*history.reported_end) - static_cast<std::int64_t>(*history.truth_end)];
  history.open = false;
}

void AccuracyTally::relate(History& history) {
  Stay& truth = history.truth;
  Stay& reported = history.reported;
  if (!truth.there || !reported.there || truth.answered || reported.answered) return;
  truth.answered = reported.answered = true;
  ++result_.answered_contacts;
  ++result_.begins.events[static_cast<std::int64_t>(reported.begin) - static_cast<std::int64_t>(truth.begin)];
  history.open = true;
  history.truth_end.reset();
  history.reported_end.reset();
}

void AccuracyTally::forget_old() {
  constexpr std::uint64_t kStepsBetween = 16;
  if (step_ % kStepsBetween != 0) return;
  std::erase_if(histories_, [this](const auto& entry) {
    const auto& [truth, reported, open, truth_end, reported_end] = entry.second;
    if (truth.there || reported.there || open) return false;
    return std::max(truth.begin, reported.begin) + flicker_steps_ < step_;
  });
}

const std::vector<ScenePair>& PairsOfEvents::step(const Events<SceneKey>& events) {
  const std::vector<ScenePair> left = without(pairs_, events.ends);
  pairs_.clear();
  std::set_union(left.begin(), left.end(), events.begins.begin(), events.begins.end(), std::back_inserter(pairs_),
                 kBefore);
  return pairs_;
}

}  // namespace sweepgrid::accuracy
