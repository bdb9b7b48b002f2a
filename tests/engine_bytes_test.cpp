// Stats::bytes() is what the heap holds for an engine, whatever the engine has been through.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine_client.hpp"
#include "watched_heap.hpp"

namespace sweepgrid::engine_bytes_test {
namespace {

using Box3 = Box<float, 3>;

/// A key of a client's own that holds no memory.
struct Name {
  std::array<char, 12> letters{};

  explicit Name(std::uint64_t number) { std::to_string(number).copy(letters.data(), letters.size()); }
  friend auto operator<=>(const Name&, const Name&) = default;
};

struct NameHash {
  std::size_t operator()(const Name& name) const {
    return std::hash<std::string_view>()({name.letters.data(), name.letters.size()});
  }
};

/// An engine with objects that are spread evenly, each with about one neighbour that it overlaps; and what the heap has
/// come to hold since before the engine was made.
template <class EngineType, class Key>
class Play {
 public:
  Play(const Config& config, std::uint64_t objects)
      : objects_(objects),
        uncounted_(config.executor ? kNodes : 0),
        before_(heap::bytes()),
        engine_(std::make_unique<EngineType>(config)) {}

  void insert() {
    for (std::uint64_t object = 0; object < objects_; ++object) engine_->insert(Key(object), box(object, 0));
    engine_->step();
  }
  /// From where they were inserted.
  void move(int steps) {
    for (int step = 1; step <= steps; ++step) {
      for (std::uint64_t object = 0; object < objects_; ++object) {
        engine_->update(Key(object), box(object, static_cast<float>(step) * 0.125F));
      }
      engine_->step();
    }
  }
  /// So many of them, all to one point.
  void flood(std::uint64_t count) {
    for (std::uint64_t object = 0; object < count; ++object) engine_->update(Key(object), {{0, 0, 0}, {1, 1, 1}});
    engine_->step();
  }
  void erase(std::uint64_t count) {
    objects_ -= count;
    for (std::uint64_t object = objects_; object < objects_ + count; ++object) engine_->erase(Key(object));
    engine_->step();
  }
  void idle() {
    for (int step = 0; step < 70; ++step) engine_->step();
  }

  void expect_counted(const std::string& when) const {
    const std::int64_t held = heap::bytes() - before_;
    const auto counted = static_cast<double>(engine_->stats().bytes());
    EXPECT_NEAR(counted, static_cast<double>(held), 0.05 * static_cast<double>(held) + uncounted_) << when;
  }

 private:
  static constexpr double kNodes = 1500;  // bytes of oneTBB's for the stages of a step on threads

  [[nodiscard]] Box3 box(std::uint64_t object, float shift) const {
    std::uint64_t bits = (object + 1) * 0x9e3779b97f4a7c15U;
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = static_cast<float>(bits >> 44) / 0x1p20F * 2 * std::cbrt(static_cast<float>(objects_)) + shift;
      box.max[axis] = box.min[axis] + 1;
      bits *= 0xd6e8feb86659fd93U;
    }
    return box;
  }

  std::uint64_t objects_;
  double uncounted_;
  std::int64_t before_;
  std::unique_ptr<EngineType> engine_;
};

template <class EngineType, class Key>
void expect_counted_throughout(const Config& config, std::uint64_t objects, const std::string& name) {
  Play<EngineType, Key> play(config, objects);
  play.expect_counted(name + ", made");
  play.insert();
  play.expect_counted(name + ", inserted");
  play.move(5);
  play.expect_counted(name + ", moved");
  play.idle();
  play.expect_counted(name + ", idle");
  play.flood(300);
  play.expect_counted(name + ", in a flood");
  play.move(2);
  play.expect_counted(name + ", after the flood");
  play.idle();
  play.expect_counted(name + ", idle after the flood");
  play.erase(objects / 10 * 9);
  play.expect_counted(name + ", most erased");
  play.idle();
  play.expect_counted(name + ", idle after most were erased");
  play.erase(objects - objects / 10 * 9);
  play.idle();
  play.expect_counted(name + ", all erased");
}

using oracle::NamedConfig;

Config with_envelopes(bool exact, double margin_steps) {
  Config config = serial();
  config.envelope = EnvelopeOptions{};
  config.envelope->margin = 0.1;
  config.envelope->margin_steps = margin_steps;
  config.envelope->exact = exact;
  return config;
}

std::vector<NamedConfig> envelopes() {
  return {{"envelopes", with_envelopes(false, 0)},
          {"envelopes by speed", with_envelopes(false, 4)},
          {"exact envelopes", with_envelopes(true, 4)}};
}

using ByNumber = Engine<float, 3>;
using ByShortNumber = Engine<float, 3, std::int16_t>;
using ByName = Engine<float, 3, Name, NameHash>;

TEST(EngineBytes, AreWhatTheHeapHoldsForManyObjects) {
  constexpr std::uint64_t kObjects = 20'000;
  Config counts = serial();
  counts.reduction = Reduction::kWitnessCounts;
  expect_counted_throughout<ByNumber, std::uint64_t>(serial(), kObjects, "default");
  expect_counted_throughout<ByNumber, std::uint64_t>(counts, kObjects / 4, "counts");
  expect_counted_throughout<ByName, Name>(serial(), kObjects / 4, "names");
  expect_counted_throughout<ByNumber, std::uint64_t>(with_envelopes(true, 4), kObjects, "exact envelopes");
}

TEST(EngineBytes, AreWhatTheHeapHoldsInEverySetting) {
  for (const NamedConfig& setting : oracle::all_configs()) {
    expect_counted_throughout<ByNumber, std::uint64_t>(setting.config, 1500, setting.name);
  }
}

TEST(EngineBytes, AreWhatTheHeapHoldsWithEnvelopes) {
  for (const NamedConfig& setting : envelopes()) {
    expect_counted_throughout<ByNumber, std::uint64_t>(setting.config, 1500, setting.name);
  }
}

TEST(EngineBytes, AreWhatTheHeapHoldsWithOtherKeys) {
  for (const NamedConfig& setting : envelopes()) {
    expect_counted_throughout<ByName, Name>(setting.config, 1500, "names, " + setting.name);
  }
  expect_counted_throughout<ByShortNumber, std::int16_t>(serial(), 1500, "short numbers");
}

TEST(EngineBytes, AreWhatTheHeapHoldsOnThreads) {
  Config config = with_envelopes(true, 4);
  config.executor = make_executor(3);
  config.parallel_from = 0;
  expect_counted_throughout<ByName, Name>(config, 5000, "names, exact envelopes, 3 threads");
  config = Config{};
  config.executor = make_executor(3);
  config.parallel_from = 0;
  config.reduction = Reduction::kWitnessCounts;
  expect_counted_throughout<ByNumber, std::uint64_t>(config, 5000, "counts, 3 threads");
}

TEST(EngineBytes, CountTheTasksThatAreRecorded) {
  const std::int64_t before = heap::bytes();
  ByNumber engine(with_envelopes(true, 0));
  engine.record_tasks(true);
  for (std::uint64_t key = 0; key < 100; ++key) engine.insert(key, {{0, 0, 0}, {1, 1, 1}});
  engine.step();
  const auto held = static_cast<double>(heap::bytes() - before);
  EXPECT_NEAR(static_cast<double>(engine.stats().bytes()), held, 0.05 * held);
}

}  // namespace
}  // namespace sweepgrid::engine_bytes_test
