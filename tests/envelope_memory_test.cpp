// When memory ends within a step with envelopes, the step throws, and the engine is as if it had not been called; what
// a crowded step took goes back, and what stats() says is held is held.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <vector>

#include "envelope_play.hpp"
#include "watched_heap.hpp"

namespace sweepgrid::oracle::envelope_memory_test {
namespace {

struct Setting {
  const char* name;
  EnvelopeOptions options;
};

const std::vector<Setting>& settings() {
  static const std::vector<Setting> all = {
      {"margin", {.margin = 2}},
      {"margin by steps", {.margin = 1, .margin_steps = 2, .stride = 2, .on_violation = OnViolation::kQuery}},
      {"swept", {.margin = 1, .swept = true}},
      {"swept stride", {.margin = 2, .swept = true, .stride = 3, .on_violation = OnViolation::kQuery}},
      {"stride", {.margin = 4, .stride = 3}},
      {"exact", {.margin = 2, .exact = true}},
      {"exact stride", {.margin = 4, .stride = 3, .exact = true}},
      {"exact stride that queries", {.margin = 2, .stride = 3, .on_violation = OnViolation::kQuery, .exact = true}},
  };
  return all;
}

/// Steps while `count` allocations from the given one on fail. Returns whether the step was done.
template <class EngineType>
bool step_without_memory(EngineType& engine, std::int64_t first, std::int64_t count, Events<std::uint64_t>& events) {
  const Events<std::uint64_t>* heard = nullptr;
  {
    const heap::Failing failing(first, count);
    try {
      heard = &engine.step();
    } catch (const std::bad_alloc&) {
    }
  }
  if (heard != nullptr) events = *heard;
  return heard != nullptr;
}

/// By keys, for which id an object gets depends on which steps failed.
template <class EngineType>
std::vector<std::uint64_t> outside_of(const EngineType& engine) {
  std::vector<std::uint64_t> keys;
  for (const Handle object : engine.envelope_report().outside) keys.push_back(engine.key(object));
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::string difference_of_reports(const EnvelopeReport& wanted, const EnvelopeReport& found) {
  if (wanted.steps != found.steps) return "the report has another number of steps";
  if (wanted.queries != found.queries || wanted.early != found.early) return "the report has other queries";
  if (wanted.violations != found.violations || wanted.outside.size() != found.outside.size()) {
    return "the report has another number of objects";
  }
  if (wanted.margin != found.margin) return "the report has another margin";
  return wanted.candidates == found.candidates ? "" : "the report has another number of candidates";
}

/// Lets each step of a script fail at each of its allocations before it is done: at that alone, and at all from there
/// on. Says what was wrong and when.
template <class Scalar, int Dim>
std::string play_failing(const Config& config, SceneScript<Scalar, Dim> script, int steps, int& failed) {
  Engine<Scalar, Dim> engine(config);
  Engine<Scalar, Dim> other(config);  // has all the memory
  EngineModel<Scalar, Dim> model;
  Listener listener;
  for (int step = 0; step < steps; ++step) {
    const EngineOps<Scalar, Dim> ops = script.next();
    queue(engine, ops, Calls::kByHandle);
    queue(other, ops, Calls::kByHandle);
    model.apply(ops);
    const Pairs pairs = other.pairs();
    const EnvelopeReport report = other.envelope_report();
    Events<std::uint64_t> events;
    bool done = false;
    // Every allocation while they are few, later every few; without a stride, so that all are tried over the steps.
    for (std::int64_t first = 0; !done; first += 1 + (first + step) / 24) {
      const std::string when = "step " + std::to_string(step) + ", allocation " + std::to_string(first) + ": ";
      for (const std::int64_t count : {heap::Failing::kAllAfter, std::int64_t{1}}) {
        done = step_without_memory(engine, first, count, events);
        if (done) break;
        ++failed;
        if (engine.pairs() != pairs) return when + "pairs() is wrong after it failed";
        const std::string wrong = difference_of_reports(report, engine.envelope_report());
        if (!wrong.empty()) return when + wrong + " after it failed";
      }
    }
    model.step();
    const std::string when = "step " + std::to_string(step) + ": ";
    std::string wrong = difference(other.step(), events);
    if (wrong.empty()) wrong = difference_of_reports(other.envelope_report(), engine.envelope_report());
    if (wrong.empty() && outside_of(other) != outside_of(engine)) wrong = "the report has other objects";
    if (wrong.empty()) wrong = listener.hear(events);
    if (wrong.empty()) wrong = compare_envelopes(config.envelope.value(), engine, model, listener);
    if (!wrong.empty()) return when + wrong;
  }
  return {};
}

template <class Scalar, int Dim>
int play_all() {
  int failed = 0;
  std::uint64_t turn = 0;
  const SceneRegime regime{
      .name = "few", .population = 24, .churn_percent = 8, .rebirth_percent = 5, .mayfly_percent = 5, .steps = 7};
  for (const Setting& setting : settings()) {
    ++turn;
    if (kSanitized && turn % 2 != 0) continue;
    Config config;
    config.threads = 1;  // for oneTBB's own allocations must not fail
    config.reduction = kReductions[turn % 2];
    config.envelope = setting.options;
    const SceneScript<Scalar, Dim> script(regime, turn);
    EXPECT_EQ(play_failing(config, script, regime.steps, failed), "") << setting.name;
  }
  return failed;
}

TEST(EnvelopesWithoutMemory, AStepIsDoneWhollyOrNotAtAllInFloat2) { EXPECT_GT((play_all<float, 2>()), 500); }
TEST(EnvelopesWithoutMemory, AStepIsDoneWhollyOrNotAtAllInFloat3) { EXPECT_GT((play_all<float, 3>()), 500); }
TEST(EnvelopesWithoutMemory, AStepIsDoneWhollyOrNotAtAllInInt2) { EXPECT_GT((play_all<std::int32_t, 2>()), 500); }
TEST(EnvelopesWithoutMemory, AStepIsDoneWhollyOrNotAtAllInInt3) { EXPECT_GT((play_all<std::int32_t, 3>()), 500); }

// An early query fails, and the step after it is none: then that step makes the cells anew.
TEST(EnvelopesWithoutMemory, AStepBetweenQueriesLeavesPairsToAskFor) {
  for (const bool exact : {false, true}) {
    for (std::int64_t first = 0; first < 60; ++first) {
      Config config;
      config.threads = 1;
      config.envelope = EnvelopeOptions{.margin = 1, .stride = 4, .on_violation = OnViolation::kQuery, .exact = exact};
      Engine<float, 2> engine(config);
      const Handle a = engine.insert(1, {{0, 0}, {1, 1}});
      engine.insert(2, {{1, 1}, {2, 2}});
      EXPECT_EQ(engine.step().begins.size(), 1U);
      engine.update(a, {{50, 0}, {51, 1}});
      Events<std::uint64_t> events;
      const bool done = step_without_memory(engine, first, heap::Failing::kAllAfter, events);
      engine.update(a, {{0, 0}, {1, 1}});
      for (int step = 0; step < 4; ++step) {
        const Events<std::uint64_t>& heard = engine.step();
        EXPECT_EQ(heard.begins.size(), done && step == 0 ? 1U : 0U);
        EXPECT_TRUE(heard.ends.empty());
        EXPECT_EQ(engine.pairs(), (Pairs{{1, 2}})) << first << ", step " << step;
      }
      engine.validate();
    }
  }
}

// Objects on circles that are closed within 39 steps: what a lap needs, the next one has. Of the steps that are about
// envelopes alone: no object left its own.
TEST(EnvelopeMemory, AWarmStepInsideOfEnvelopesAllocatesNothing) {
  for (const Setting& setting : settings()) {
    Config config;
    config.threads = 1;
    config.envelope = setting.options;
    Engine<float, 2> engine(config);
    std::vector<Handle> handles;
    std::vector<Box<float, 2>> boxes(60);
    const auto place = [&](int step) {
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const double angle = 6.28318530718 * (step % 39) / 39 + static_cast<double>(i);
        const auto x = static_cast<float>(12 * std::cos(static_cast<double>(i) * 1.7) + 2 * std::cos(angle));
        const auto y = static_cast<float>(12 * std::sin(static_cast<double>(i) * 2.3) + 2 * std::sin(angle));
        boxes[i] = {{x, y}, {x + 2, y + 2}};
      }
    };
    place(0);
    for (std::size_t i = 0; i < boxes.size(); ++i) handles.push_back(engine.insert(i, boxes[i]));
    std::int64_t allocations = 0;
    int steps = 0;
    for (int step = 0; step < 220; ++step) {
      // Every third step, nearly nobody moves, so that steps without a query have such that leave no envelope.
      place(step - step % 3);
      for (std::size_t i = 0; i < boxes.size(); ++i) engine.update(handles[i], boxes[i]);
      const std::int64_t before = heap::allocations();
      engine.step();
      const std::int64_t own = heap::allocations() - before;
      if (step < 130 || engine.stats().step.updates > 0) continue;
      allocations += own;
      ++steps;
    }
    EXPECT_EQ(allocations, 0) << setting.name;
    EXPECT_GT(steps, 20) << setting.name;
  }
}

// A crowd under an exact filter: candidates, events, what is queued for the lists.
TEST(EnvelopeMemory, OfACrowdGoesBack) {
  Config config;
  config.threads = 1;
  config.envelope = EnvelopeOptions{.margin = 0.1, .exact = true};
  Engine<float, 2> engine(config);
  std::vector<Handle> handles;
  const auto box = [](int i, bool crowd) {
    const float x = crowd ? 0.001F * static_cast<float>(i) : 5.0F * static_cast<float>(i);
    return Box<float, 2>({x, 0}, {x + 1, 1});
  };
  for (int i = 0; i < 300; ++i) handles.push_back(engine.insert(static_cast<std::uint64_t>(i), box(i, false)));
  for (int step = 0; step < 200; ++step) engine.step();
  const std::size_t before = engine.stats().bytes_witnesses;
  for (int i = 0; i < 300; ++i) engine.update(handles[static_cast<std::size_t>(i)], box(i, true));
  engine.step();
  EXPECT_EQ(engine.stats().pairs, 300U * 299U / 2U);
  // Each pair twice in the lists, and once as an event and twice as a change.
  EXPECT_GE(engine.stats().bytes_witnesses, 300U * 299U / 2U * (8U + 8U + 16U));
  for (int i = 0; i < 300; ++i) engine.update(handles[static_cast<std::size_t>(i)], box(i, false));
  for (int step = 0; step < 3 * 64 + 2; ++step) engine.step();
  EXPECT_EQ(engine.stats().pairs, 0U);
  EXPECT_LE(engine.stats().bytes_witnesses, before + 1000);
}

}  // namespace
}  // namespace sweepgrid::oracle::envelope_memory_test
