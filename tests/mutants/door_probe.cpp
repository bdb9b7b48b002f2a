// A small oracle test of the calls that queue ops, one by one and many at once: `run` builds it anew for every planted
// bug. Exits with 1 and prints the name of what is broken when it notices something. "door": a call gives, refuses or
// leaves behind something else than as many calls for one object do.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client.hpp"
#include "op_script.hpp"

namespace sweepgrid {
namespace {

using Key = std::uint64_t;
using Box2 = Box<float, 2>;

/// Many keys have the same hash.
struct PoorHash {
  std::size_t operator()(Key key) const { return key % 1024; }
};

using TestEngine = Engine<float, 2, Key, PoorHash>;

struct Finding : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void require(bool good, const std::string& what) {
  if (!good) throw Finding("door: " + what);
}

/// What the call says when it is refused; nothing when it is not.
std::optional<std::string> refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return std::nullopt;
}

/// An engine of many workers that is called for many objects at once, and one of one worker that is called for each.
class Twins {
 public:
  Twins(std::uint64_t seed, StepMethod method)
      : random_(seed),
        bulk_(config(std::make_shared<Backwards>(), method)),
        single_(config(make_serial_executor(), method)) {}

  void insert(std::size_t count) {
    std::vector<Key> keys;
    for (std::size_t i = 0; i < count; ++i) keys.push_back(next_key_++ * 7919 % 1'000'003);
    std::vector<Box2> boxes = some_boxes(count);
    if (count > 2 && !live_.empty()) {
      const std::size_t bad = spoiled(count);
      std::vector<Key> bad_keys = keys;
      for (const std::size_t item : {bad, count - 1}) bad_keys[item] = live_.begin()->first;
      expect_refused([&] { bulk_.insert(bad_keys, boxes); }, "the key names a live object");
      std::vector<Box2> bad_boxes = boxes;
      bad_boxes[bad].min[0] = bad_boxes[count - 1].min[0] = std::numeric_limits<float>::quiet_NaN();
      expect_refused([&] { bulk_.insert(keys, bad_boxes); }, "insert of object " + std::to_string(keys[bad]) + ":");
    }
    const std::vector<Handle> handles = bulk_.insert(keys, boxes);
    for (std::size_t i = 0; i < count; ++i) {
      require(single_.insert(keys[i], boxes[i]) == handles[i], "other handles than one by one");
      live_[keys[i]] = {handles[i], boxes[i]};
      client_.set(keys[i], boxes[i]);
    }
  }

  /// Names some objects twice; `shuffled`: in no order.
  void update(std::size_t count, bool shuffled) {
    std::vector<Key> keys = some_keys(count, shuffled);
    for (std::size_t i = 0; i + 1 < keys.size(); i += 3) keys[i + 1] = keys[i];
    const std::vector<Box2> boxes = some_boxes(keys.size());
    const std::vector<Handle> handles = handles_of(keys);
    if (keys.size() > 2) {
      const std::size_t bad = spoiled(keys.size());
      std::vector<Box2> bad_boxes = boxes;
      bad_boxes[bad].min[1] = bad_boxes.back().min[1] = std::numeric_limits<float>::infinity();
      expect_refused([&] { bulk_.update(handles, bad_boxes); }, "update of object " + std::to_string(keys[bad]) + ":");
      if (!dead_.empty()) {
        std::vector<Handle> bad_handles = handles;
        bad_handles[bad] = dead_[bad % dead_.size()];
        expect_refused([&] { bulk_.update(bad_handles, boxes); }, "the handle is stale");
      }
    }
    bulk_.update(handles, boxes);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      single_.update(handles[i], boxes[i]);
      live_[keys[i]].box = boxes[i];
      client_.set(keys[i], boxes[i]);
    }
  }

  void erase(std::size_t count, bool shuffled) {
    const std::vector<Key> keys = some_keys(count, shuffled);
    const std::vector<Handle> handles = handles_of(keys);
    if (keys.size() > 2) {
      std::vector<Handle> twice = handles;
      twice.back() = twice[spoiled(keys.size())];
      expect_refused([&] { bulk_.erase(twice); }, "the call names it twice");
    }
    bulk_.erase(handles);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      single_.erase(handles[i]);
      live_.erase(keys[i]);
      client_.erase(keys[i]);
      dead_.push_back(handles[i]);
    }
  }

  /// All calls for one object.
  void turn_over() {
    insert(1);
    const auto [key, object] = *live_.rbegin();
    for (TestEngine* engine : {&bulk_, &single_}) {
      engine->update(object.handle, some_boxes(1)[0]);
      engine->erase(key);
      require(!engine->contains(key), "an erased key is known");
      require(engine->insert(key, object.box) != object.handle, "a handle names two objects");
    }
    dead_.push_back(object.handle);
    live_[key].handle = bulk_.find(key).value();
    expect_known();
  }

  void step() {
    std::vector<Key> keys;
    for (Key key = 0; key < 50; ++key) keys.push_back(2'000'000 + key);
    std::vector<Box2> boxes = some_boxes(keys.size());
    boxes.back().min[0] = std::numeric_limits<float>::infinity();
    expect_refused([&] { bulk_.insert(keys, boxes); }, "min > max");  // must not be heard of in the step
    const auto& events = bulk_.step();
    if (const std::string finding = client_.hear(events); !finding.empty()) throw Finding(finding);
    require(single_.step() == events, "other events than one by one");
    require(bulk_.stats().step == single_.stats().step, "other counters than one by one");
    expect_known();
    bulk_.validate();
  }

  [[nodiscard]] std::size_t size() const { return live_.size(); }

 private:
  struct Object {
    Handle handle;
    Box2 box;
  };

  static Config config(std::shared_ptr<Executor> executor, StepMethod method) {
    Config config;
    config.executor = std::move(executor);
    config.parallel_from = 0;
    config.step_method = method;
    config.cell_size = 4;
    return config;
  }

  std::size_t spoiled(std::size_t count) {
    return static_cast<std::size_t>(random_.below(static_cast<int>(count - 1)));
  }

  std::vector<Box2> some_boxes(std::size_t count) {
    std::vector<Box2> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      const auto x = static_cast<float>(random_.below(100'000)) / 10;
      const auto y = static_cast<float>(random_.below(4));
      boxes.push_back(Box2({x, y}, {x + 0.5F, y + 0.5F}));
    }
    return boxes;
  }

  /// In the order of handles unless shuffled.
  std::vector<Key> some_keys(std::size_t count, bool shuffled) {
    std::vector<std::pair<std::uint32_t, Key>> all;
    for (const auto& [key, object] : live_) all.emplace_back(object.handle.index, key);
    std::sort(all.begin(), all.end());
    const auto pick = [&](std::size_t from) {
      return from + static_cast<std::size_t>(random_.below(static_cast<int>(all.size() - from)));
    };
    count = std::min(count, all.size());
    if (shuffled) {
      for (std::size_t i = 0; i < count; ++i) std::swap(all[i], all[pick(i)]);
    }
    std::vector<Key> keys;
    for (std::size_t i = 0; i < count; ++i) keys.push_back(all[i].second);
    return keys;
  }

  [[nodiscard]] std::vector<Handle> handles_of(const std::vector<Key>& keys) const {
    std::vector<Handle> handles;
    for (const Key key : keys) handles.push_back(live_.at(key).handle);
    return handles;
  }

  void expect_refused(const std::function<void()>& call, const std::string& text) {
    const auto said = refusal(call);
    require(said.has_value(), "nothing is refused that should be: " + text);
    require(said->find(text) != std::string::npos, "refused with '" + *said + "' instead of '" + text + "'");
    expect_known();
  }

  /// Boxes, keys and handles are those of all calls that were not refused.
  void expect_known() {
    require(bulk_.size() == live_.size(), "the number of objects is " + std::to_string(bulk_.size()));
    for (const auto& [key, object] : live_) {
      require(bulk_.find(key) == object.handle, "key " + std::to_string(key) + " has no handle or another");
      require(bulk_.key(object.handle) == key && bulk_.box(object.handle) == object.box,
              "object " + std::to_string(key) + " has another key or box");
    }
    for (std::size_t i = 0; i < dead_.size(); i += 1 + dead_.size() / 500) {
      require(refusal([&] { static_cast<void>(bulk_.box(dead_[i])); }).has_value(), "a stale handle is good");
    }
  }

  oracle::Random random_;
  TestEngine bulk_;
  TestEngine single_;
  Client client_;
  std::map<Key, Object> live_;
  std::vector<Handle> dead_;
  Key next_key_ = 0;
};

void play(StepMethod method, std::initializer_list<std::size_t> sizes) {
  Twins twins(1, method);
  for (const std::size_t most : sizes) {
    twins.insert(most);
    twins.step();
    twins.update(most, false);
    twins.update(most / 2, true);
    twins.step();
    twins.update(most, true);
    twins.erase(most / 3, true);
    twins.insert(most / 4);
    twins.turn_over();
    twins.step();
    twins.erase(most / 3, false);
    twins.turn_over();
    twins.step();
    twins.erase(twins.size() - 20, true);
    twins.step();
    twins.insert(100);
    twins.step();
  }
}

}  // namespace
}  // namespace sweepgrid

int main() {
  try {
    // Enough for every way of sharing out the work, then few, and again.
    sweepgrid::play(sweepgrid::StepMethod::kCells, {300, 20'000});
    sweepgrid::play(sweepgrid::StepMethod::kSweep, {300});
  } catch (const sweepgrid::Finding& finding) {
    std::cout << finding.what() << '\n';
    return 1;
  } catch (const std::invalid_argument& error) {
    std::cout << "door: refused without a reason: " << error.what() << '\n';
    return 1;
  } catch (const std::exception& error) {
    std::cout << sweepgrid::text_of(error) << '\n';
    return 1;
  }
  return 0;
}
