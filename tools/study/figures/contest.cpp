#include "study/figures/contest.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "measure/in_turn.hpp"
#include "measure/stopwatch.hpp"
#include "setup/json_text.hpp"

namespace sweepgrid::study {
namespace {

using nlohmann::json;

constexpr int kWarmUpRounds = 1;

std::string complaint(const std::vector<PairKey>& found, const std::vector<PairKey>& expected) {
  if (found == expected) return "";
  const auto count = [](const std::vector<PairKey>& all, const std::vector<PairKey>& some) {
    std::vector<PairKey> rest;
    std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(rest));
    return rest.size();
  };
  return fmt::format("{} pairs are missing, {} are too many", count(expected, found), count(found, expected));
}

/// A system on its way through a script.
class Player {
 public:
  Player(const SystemSpec& spec, const Script& script) : script_(&script), system_(make_system(spec, script)) {
    play_steps(1);
  }

  // The mean time of a step.
  double play_steps(int count) {
    double seconds = 0;
    for (int i = 0; i < count; ++i) {
      const ThreadStopwatch watch;
      system_->step(script_->steps[next_++]);
      seconds += watch.seconds();
      system_->settle();
    }
    return seconds / count;
  }

  [[nodiscard]] Work work() const { return system_->work(); }
  [[nodiscard]] std::string complaint_at_end() const { return complaint(system_->pairs(), script_->pairs); }

 private:
  const Script* script_;
  std::unique_ptr<System> system_;
  std::size_t next_ = 0;
};

json work_json(const Work& work) {
  return {{"swaps", work.cells.swaps},
          {"box_tests", work.cells.box_tests},
          {"deltas", work.cells.deltas},
          {"local_sorts", work.cells.local_sorts},
          {"global_sorts", work.cells.global_sorts},
          {"updates", work.updates},
          {"cell_ops", work.cell_ops},
          {"cells_drained", work.cells_drained},
          {"events", work.events}};
}

Work work_of(const json& from) {
  Work work;
  get_member(from, "swaps", work.cells.swaps);
  get_member(from, "box_tests", work.cells.box_tests);
  get_member(from, "deltas", work.cells.deltas);
  get_member(from, "local_sorts", work.cells.local_sorts);
  get_member(from, "global_sorts", work.cells.global_sorts);
  get_member(from, "updates", work.updates);
  get_member(from, "cell_ops", work.cell_ops);
  get_member(from, "cells_drained", work.cells_drained);
  get_member(from, "events", work.events);
  return work;
}

}  // namespace

Contest play(const ContestPlan& plan) {
  const int steps = (kWarmUpRounds + plan.rounds) * plan.steps_per_round;
  Contest contest;
  contest.scene = fmt::format("{},steps={}", plan.scene, steps);
  const Script script = make_script(contest.scene);
  contest.pairs = script.pairs.size();
  std::vector<Player> players;
  players.reserve(plan.systems.size());
  std::vector<std::function<double()>> turns;
  turns.reserve(plan.systems.size());
  for (const SystemSpec& spec : plan.systems) players.emplace_back(spec, script);
  for (Player& player : players) turns.emplace_back([&] { return player.play_steps(plan.steps_per_round); });
  (void)measure_in_turn(kWarmUpRounds, turns);
  std::vector<Work> before;
  before.reserve(players.size());
  for (const Player& player : players) before.push_back(player.work());
  const std::vector<std::vector<double>> samples = measure_in_turn(plan.rounds, turns);
  for (std::size_t i = 0; i < players.size(); ++i) {
    Entry& entry = contest.entries.emplace_back();
    entry.system = plan.systems[i].name;
    entry.x = plan.systems[i].x;
    entry.seconds = samples[i];
    entry.work = players[i].work() - before[i];
    entry.steps = static_cast<std::uint64_t>(plan.rounds) * static_cast<std::uint64_t>(plan.steps_per_round);
    entry.complaint = players[i].complaint_at_end();
  }
  return contest;
}

json to_json(const Contest& contest) {
  json entries = json::array();
  for (const Entry& entry : contest.entries) {
    entries.push_back({{"system", entry.system},
                       {"x", entry.x},
                       {"seconds", entry.seconds},
                       {"work", work_json(entry.work)},
                       {"steps", entry.steps},
                       {"complaint", entry.complaint}});
  }
  return {{"scene", contest.scene}, {"pairs", contest.pairs}, {"entries", entries}};
}

Contest contest_of(const json& from) {
  Contest contest;
  get_member(from, "scene", contest.scene);
  get_member(from, "pairs", contest.pairs);
  for (const auto& one : member_of<nlohmann::json>(from, "entries")) {
    Entry& entry = contest.entries.emplace_back();
    get_member(one, "system", entry.system);
    get_member(one, "x", entry.x);
    get_member(one, "seconds", entry.seconds);
    entry.work = work_of(member_of<json>(one, "work"));
    get_member(one, "steps", entry.steps);
    get_member(one, "complaint", entry.complaint);
  }
  return contest;
}

}  // namespace sweepgrid::study
