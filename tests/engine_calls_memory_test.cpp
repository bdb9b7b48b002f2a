// The whole interface, with each allocation of each call failing in turn, alone and with all that come after it: a call
// happens wholly or not at all, and the next step is right.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/scheduler/stage_graph.hpp>

#include "engine_client.hpp"
#include "watched_heap.hpp"

namespace sweepgrid::engine_calls_memory_test {
namespace {

/// Which allocations fail.
enum class Fails {
  kOne,
  kAllAfter,
  kSome,  ///< one now and then, and the client leaves it at that half of the time
};

/// What a client sees between two calls.
struct Seen {
  std::size_t size = 0;
  std::map<std::uint64_t, std::pair<Handle, Box2>> objects;
  Pairs pairs;
  std::size_t pair_count = 0;
  std::uint64_t steps = 0;

  friend bool operator==(const Seen&, const Seen&) = default;
};

constexpr std::uint64_t kKeys = 48;

Seen look(const Engine2& engine) {
  Seen seen;
  seen.size = engine.size();
  for (std::uint64_t key = 0; key < kKeys; ++key) {
    if (const auto handle = engine.find(key)) seen.objects[key] = {*handle, engine.box(*handle)};
  }
  seen.pairs = engine.pairs();
  const Stats stats = engine.stats();
  seen.pair_count = stats.pairs;
  seen.steps = stats.steps;
  return seen;
}

/// A call, ready to be made: all that it needs is there.
using Ready = std::function<void()>;
/// Readies a call to an engine.
using Call = std::function<Ready(Engine2&)>;

/// Makes calls to an engine whose memory fails. Once a call is made, a twin makes it, which has memory without end and
/// does not know of steps that were refused.
class FailingClient {
 public:
  FailingClient(const Config& config, Fails fails, std::uint64_t seed)
      : fails_(fails), random_(seed), engine_(config), twin_(config) {
    if (!config.envelope || config.envelope->exact) model_.emplace();
  }

  /// Returns whether the call was made in the end.
  bool make(const char* name, const Call& call) {
    const Seen before = look(engine_);
    for (std::int64_t first = 0;; first = next(first)) {
      if (!attempt(name, call(engine_), first)) {
        expect_unchanged(name, before, first);
        if (fails_ == Fails::kSome && random_.percent(50)) return false;
        continue;
      }
      call(twin_)();
      twin_.set_step_bytes(std::nullopt);
      const Seen expected = look(twin_);
      const Seen found = look(engine_);
      EXPECT_EQ(found.size, expected.size) << name;
      EXPECT_EQ(found.objects.size(), expected.objects.size()) << name;
      EXPECT_EQ(found.pairs, before.pairs) << name;
      return true;
    }
  }

  void step() {
    const Seen before = look(engine_);
    Events<std::uint64_t> events;
    for (std::int64_t first = 0;; first = next(first)) {
      const Events<std::uint64_t>* told = nullptr;
      const bool done = attempt(
          "step", [&] { told = &engine_.step(); }, first);
      if (done && engine_.status() == StepStatus::kDone) {
        events = *told;
        break;
      }
      expect_unchanged("step", before, first);
      EXPECT_TRUE(!done || (told->begins.empty() && told->ends.empty()));
      if (done && failed_ == 0) return;  // over the budget
      if (!done && fails_ == Fails::kSome && random_.percent(50)) return;
    }
    EXPECT_EQ(oracle::difference(twin_.step(), events), "");
    EXPECT_EQ(twin_.status(), StepStatus::kDone);
    EXPECT_EQ(engine_.pairs(), twin_.pairs());
    if (model_) {
      EXPECT_EQ(oracle::difference(model_->step(), events), "");
      EXPECT_EQ(engine_.pairs(), model_->pairs());
    }
    engine_.validate();
    ++done_;
  }

  [[nodiscard]] const Engine2& engine() const { return engine_; }
  [[nodiscard]] oracle::Random& random() { return random_; }
  [[nodiscard]] oracle::EngineModel<float, 2>& model() { return model_ ? *model_ : unused_; }
  [[nodiscard]] int failures() const { return failures_; }
  [[nodiscard]] int done() const { return done_; }

 private:
  /// Makes the call while memory fails from the given allocation on; returns whether it was made.
  bool attempt(const char* name, const Ready& call, std::int64_t first) {
    bool made = true;
    const heap::Failing failing(first, fails_ == Fails::kAllAfter ? heap::Failing::kAllAfter : 1);
    try {
      call();
    } catch (const std::bad_alloc&) {
      made = false;
    }
    failed_ = failing.failed();
    if (!made) ++failures_;
    if (!made && failed_ == 0) throw std::logic_error(std::string(name) + " ran out of memory by itself");
    return made;
  }

  [[nodiscard]] std::int64_t next(std::int64_t first) {
    return fails_ == Fails::kSome ? random_.below(1000) < 900 ? random_.below(150) : 1 << 30 : first + 1;
  }

  void expect_unchanged(const char* name, const Seen& before, std::int64_t first) {
    EXPECT_TRUE(look(engine_) == before) << name << " failed at allocation " << first << ", and left something behind";
  }

  Fails fails_;
  oracle::Random random_;
  Engine2 engine_;
  Engine2 twin_;
  std::optional<oracle::EngineModel<float, 2>> model_;
  oracle::EngineModel<float, 2> unused_;
  std::int64_t failed_ = 0;  // allocations of the latest attempt
  int failures_ = 0;         // calls that failed
  int done_ = 0;             // steps
};

/// A client's calls, one after another, at random.
class Calls {
 public:
  Calls(FailingClient& client, const Config& config) : client_(client), random_(client.random()), config_(config) {}

  void one() {
    const int kind = random_.below(100);
    const bool envelope = config_.envelope.has_value();
    if (kind < 12) return insert_one(envelope && random_.percent(50));
    if (kind < 22) return insert_many();
    if (kind < 38) return update_one();
    if (kind < 48) return update_many();
    if (kind < 54) return erase_one();
    if (kind < 60) return erase_many();
    if (kind < 65 && envelope) return set_margin();
    if (kind < 69) return ask();
    if (kind < 74) return set_limits();
    client_.step();
  }

 private:
  using Keys = std::vector<std::uint64_t>;

  Box2 box() {
    const auto place = [this] { return static_cast<float>(random_.below(400)) / 40; };
    const float width = random_.percent(10) ? 8 : 1;
    const float x = place();
    return square(x, place(), width);
  }
  [[nodiscard]] Keys keys(bool live) {
    Keys keys;
    for (std::uint64_t key = 0; key < kKeys; ++key) {
      if (client_.engine().contains(key) == live) keys.push_back(key);
    }
    for (std::size_t i = keys.size(); i > 1; --i) {
      std::swap(keys[i - 1], keys[static_cast<std::size_t>(random_.below(static_cast<int>(i)))]);
    }
    return keys;
  }
  /// At most `most` of them.
  Keys some(bool live, std::size_t most) {
    Keys all = keys(live);
    if (all.size() > most) all.resize(most);
    return all;
  }
  std::vector<Box2> boxes(std::size_t count) {
    std::vector<Box2> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(box());
    return all;
  }
  static std::vector<Handle> handles(const Engine2& engine, const Keys& keys) {
    std::vector<Handle> all;
    for (const std::uint64_t key : keys) all.push_back(engine.find(key).value());
    return all;
  }

  void insert_one(bool with_margin) {
    const Keys key = some(false, 1);
    if (key.empty()) return;
    const Box2 at = box();
    const bool made = client_.make("insert", [=](Engine2& engine) -> Ready {
      if (with_margin) return [=, &engine] { engine.insert(key[0], at, 0.5); };
      return [=, &engine] { engine.insert(key[0], at); };
    });
    if (made) client_.model().insert(key[0], at);
  }
  void insert_many() {
    const Keys added = some(false, static_cast<std::size_t>(random_.below(9)));
    const std::vector<Box2> at = boxes(added.size());
    const bool made = client_.make(
        "bulk insert", [=](Engine2& engine) -> Ready { return [=, &engine] { engine.insert(added, at); }; });
    for (std::size_t i = 0; made && i < added.size(); ++i) client_.model().insert(added[i], at[i]);
  }
  void update_one() {
    const Keys key = some(true, 1);
    if (key.empty()) return;
    const Box2 at = box();
    const int how = random_.below(config_.envelope && config_.envelope->swept ? 3 : 2);
    const bool made = client_.make("update", [=](Engine2& engine) -> Ready {
      const Handle handle = engine.find(key[0]).value();
      if (how == 0) return [=, &engine] { engine.update(key[0], at); };
      if (how == 1) return [=, &engine] { engine.update(handle, at); };
      return [=, &engine] { engine.update(handle, at, {0.5, -0.5}); };
    });
    if (made) client_.model().update(key[0], at);
  }
  void update_many() {
    Keys changed = some(true, static_cast<std::size_t>(random_.below(12)));
    if (!changed.empty() && random_.percent(30)) changed.push_back(changed[0]);
    const std::vector<Box2> at = boxes(changed.size());
    const bool made = client_.make("bulk update", [=](Engine2& engine) -> Ready {
      return [=, &engine, objects = handles(engine, changed)] { engine.update(objects, at); };
    });
    for (std::size_t i = 0; made && i < changed.size(); ++i) client_.model().update(changed[i], at[i]);
  }
  void erase_one() {
    const Keys key = some(true, 1);
    if (key.empty()) return;
    const bool by_key = random_.percent(50);
    const bool made = client_.make("erase", [=](Engine2& engine) -> Ready {
      if (by_key) return [=, &engine] { engine.erase(key[0]); };
      return [=, &engine, handle = engine.find(key[0]).value()] { engine.erase(handle); };
    });
    if (made) client_.model().erase(key[0]);
  }
  void erase_many() {
    const Keys gone = some(true, static_cast<std::size_t>(random_.below(8)));
    const bool made = client_.make("bulk erase", [=](Engine2& engine) -> Ready {
      return [=, &engine, objects = handles(engine, gone)] { engine.erase(objects); };
    });
    for (std::size_t i = 0; made && i < gone.size(); ++i) client_.model().erase(gone[i]);
  }
  void set_margin() {
    const Keys key = some(true, 1);
    if (key.empty()) return;
    const double margin = random_.below(4);
    client_.make("set_margin", [=](Engine2& engine) -> Ready {
      return [=, &engine, handle = engine.find(key[0]).value()] { engine.set_margin(handle, margin); };
    });
  }
  void ask() {
    client_.make("pairs", [](Engine2& engine) -> Ready { return [&engine] { static_cast<void>(engine.pairs()); }; });
    client_.make("stats", [](Engine2& engine) -> Ready { return [&engine] { static_cast<void>(engine.stats()); }; });
    client_.make("envelope_report",
                 [](Engine2& engine) -> Ready { return [&engine] { static_cast<void>(engine.envelope_report()); }; });
    client_.make("stage_names",
                 [](Engine2& engine) -> Ready { return [&engine] { static_cast<void>(engine.stage_names()); }; });
  }
  void set_limits() {
    const bool record = random_.percent(50);
    std::optional<std::uint64_t> limit;
    if (random_.percent(40)) limit = std::uint64_t{64} << random_.below(12);
    client_.make("settings", [=](Engine2& engine) -> Ready {
      return [=, &engine] {
        engine.record_tasks(record);
        engine.set_step_bytes(limit);
      };
    });
  }

  FailingClient& client_;
  oracle::Random& random_;
  Config config_;
};

struct Scene {
  const char* name;
  Config config;
};

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  const auto add = [&](const char* name, const auto& change) {
    Scene scene{name, serial()};
    change(scene.config);
    all.push_back(scene);
  };
  add("default", [](Config&) {});
  add("batch", [](Config& c) { c.cell.kind = CellKind::kBatch, c.cell_size = 4; });
  add("segmented", [](Config& c) { c.cell = {CellKind::kSegmented, 4}, c.cell_population = 30; });
  add("witness counts", [](Config& c) { c.reduction = Reduction::kWitnessCounts; });
  add("margins", [](Config& c) { c.envelope = EnvelopeOptions{.margin = 0.5, .margin_steps = 1}; });
  add("swept", [](Config& c) { c.envelope = EnvelopeOptions{.margin = 0.5, .swept = true}; });
  add("stride", [](Config& c) {
    c.envelope = EnvelopeOptions{.margin = 1, .stride = 3, .on_violation = OnViolation::kQuery};
    c.reduction = Reduction::kWitnessCounts;
  });
  add("exact", [](Config& c) { c.envelope = EnvelopeOptions{.margin = 0.5, .margin_steps = 1, .exact = true}; });
  add("exact, stride", [](Config& c) {
    c.envelope = EnvelopeOptions{.margin = 1, .stride = 3, .on_violation = OnViolation::kQuery, .exact = true};
  });
  return all;
}

TEST(WithoutMemory, ACallHappensWhollyOrNotAtAll) {
  for (const Scene& scene : scenes()) {
    for (const Fails fails : {Fails::kOne, Fails::kAllAfter, Fails::kSome}) {
      const std::int64_t before = heap::bytes();
      {
        FailingClient client(scene.config, fails, 17);
        Calls calls(client, scene.config);
        const int turns = oracle::kSanitized ? 30 : fails == Fails::kSome ? 240 : 80;
        for (int turn = 0; turn < turns && !::testing::Test::HasFailure(); ++turn) calls.one();
        client.step();
        EXPECT_GT(client.failures(), turns / 2) << scene.name;
        EXPECT_GT(client.done(), 3) << scene.name;
        if (::testing::Test::HasFailure()) FAIL() << scene.name << ", " << static_cast<int>(fails);
      }
      EXPECT_EQ(heap::bytes(), before) << scene.name << ": something was lost";
    }
  }
}

TEST(WithoutMemory, AnEngineIsMadeOrNot) {
  for (const Scene& scene : scenes()) {
    for (std::int64_t first = 0;; ++first) {
      const std::int64_t before = heap::bytes();
      bool made = true;
      {
        const heap::Failing failing(first, first % 2 == 0 ? 1 : heap::Failing::kAllAfter);
        try {
          const Engine2 engine(scene.config);
        } catch (const std::bad_alloc&) {
          made = false;
        }
      }
      EXPECT_EQ(heap::bytes(), before) << scene.name << ", allocation " << first;
      if (made) break;
    }
  }
}

// The failure of one step is not that of another.
TEST(WithoutMemory, ARunThatCannotKeepItsTraceEither) {
  StageGraph graph(make_serial_executor());
  struct Ninth {};  // takes no memory
  bool fails = true;
  std::optional<heap::Failing> failing;
  graph.add(
      "only", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(10, 1); },
      [&](std::size_t task) {
        if (task != 9 || !fails) return;
        failing.emplace(0, heap::Failing::kAllAfter);
        throw Ninth();
      });
  graph.record(true);
  EXPECT_THROW(graph.run(), Ninth);
  failing.reset();
  EXPECT_TRUE(graph.trace().empty());
  fails = false;
  EXPECT_NO_THROW(graph.run());
  EXPECT_EQ(graph.trace().size(), 10U);
}

}  // namespace
}  // namespace sweepgrid::engine_calls_memory_test
