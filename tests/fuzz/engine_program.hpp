#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

#include "../engine_model.hpp"
#include "../envelope_play.hpp"
#include "../watched_heap.hpp"
#include "engine_settings.hpp"
#include "finding.hpp"
#include "fuzz_input.hpp"
#include "fuzz_keys.hpp"

namespace sweepgrid::fuzz {

/// A program of calls to one engine, written by bytes, beside the brute-force model. After every call the engine must
/// tell what the model tells; a call with bad input must be refused, and one without memory must change nothing.
template <class Scalar, int Dim, class Key = std::uint64_t, class Hash = std::hash<Key>>
class EngineProgram {
 public:
  static void run(Input& input) {
    const auto palette = static_cast<oracle::Palette>(input.below(4));
    Config config = settings<Dim>(input, palette, kTellsEnvelopes);
    std::unique_ptr<EngineType> engine;
    try {
      engine = std::make_unique<EngineType>(config);
    } catch (const std::invalid_argument&) {
      require(!good(config.envelope), "good settings are refused");
      return;
    }
    require(good(config.envelope), "bad settings are taken");
    EngineProgram program(std::move(engine), std::move(config), palette, input);
    for (int calls = 0; calls < kCalls && !input.empty(); ++calls) program.next_call();
    program.plan_ = {};
    program.step();
  }

 private:
  using EngineType = Engine<Scalar, Dim, Key, Hash>;
  using BoxType = Box<Scalar, Dim>;
  using Model = oracle::EngineModel<Scalar, Dim, Key>;

  static constexpr int kCalls = 60;
  // What compares engines with envelopes knows one type of keys.
  static constexpr bool kTellsEnvelopes = std::is_same_v<Key, std::uint64_t>;
  /// Of calls that are made again and again with one more allocation each that goes well.
  static constexpr std::uint64_t kMostTries = 400;

  /// Which allocations of the next call fail.
  struct Plan {
    std::int64_t first = 0;
    std::int64_t count = 0;  ///< 0: none
    bool each = false;       ///< the call is repeated, with `first` greater by 1, until it goes through
  };

  EngineProgram(std::unique_ptr<EngineType> engine, Config config, oracle::Palette palette, Input& input)
      : config_(std::move(config)), boxes_(palette), input_(input), engine_(std::move(engine)) {
    for (std::size_t number = 0; number < kKeys; ++number) keys_.push_back(make_key<Key>(number));
    trace("engine of ", Dim, " dimensions, sizeof(Scalar) ", sizeof(Scalar), ", kind ",
          static_cast<int>(config_.cell.kind), ", reduction ", static_cast<int>(config_.reduction), ", step method ",
          static_cast<int>(config_.step_method), ", cell size ", config_.cell_size.value_or(0), ", population ",
          config_.cell_population.value_or(0), ", integration ", static_cast<int>(config_.cell.integration),
          ", segment capacity ", config_.cell.segment_capacity, ", threads ", config_.executor->concurrency(),
          ", step bytes ", config_.step_bytes ? std::to_string(*config_.step_bytes) : "-");
    if (config_.envelope) {
      const EnvelopeOptions& options = *config_.envelope;
      trace("envelope: margin ", options.margin, ", margin steps ", options.margin_steps, ", swept ", options.swept,
            ", stride ", options.stride, ", queries ", options.on_violation == OnViolation::kQuery, ", exact ",
            options.exact);
    }
  }

  void next_call() {
    switch (input_.below(18)) {
      case 0:
        return insert();
      case 1:
        return insert_with_margin();
      case 2:
        return update_by_key();
      case 3:
        return update_by_handle();
      case 4:
        return update_ahead();
      case 5:
        return erase_by_key();
      case 6:
        return erase_by_handle();
      case 7:
        return insert_many();
      case 8:
        return update_many();
      case 9:
        return erase_many();
      case 10:
        return set_margin();
      case 11:
        return set_step_bytes();
      case 12:
        return plan_failure();
      case 13:
        return ask_for_pairs();
      default:
        return step();
    }
  }

  // ---- what bytes name

  /// Mostly of a live object, or, with `fresh`, of none.
  Key some_key(bool fresh) {
    const std::uint8_t byte = input_.byte();
    const std::size_t number = byte % kKeys;
    if (byte >= 6 * kKeys) return keys_[number];
    for (std::size_t i = 0; i < kKeys; ++i) {
      const Key& key = keys_[(number + i) % kKeys];
      if ((handles_.count(key) == 0) == fresh) return key;
    }
    return keys_[number];
  }
  /// Mostly of a live object; else any that was ever given out, or none.
  Handle some_handle() {
    const std::uint8_t byte = input_.byte();
    if (byte < 6 * kKeys && !handles_.empty()) {
      return std::next(handles_.begin(), static_cast<std::ptrdiff_t>(byte % handles_.size()))->second;
    }
    return issued_.empty() ? Handle{} : issued_[byte % issued_.size()];
  }
  const Key* key_of(Handle handle) const {
    for (const auto& [key, own] : handles_) {
      if (own == handle) return &key;
    }
    return nullptr;
  }
  [[nodiscard]] bool live(const Key& key) const { return handles_.count(key) != 0; }

  // ---- calls that queue

  void insert() {
    const Key key = some_key(true);
    const BoxType box = boxes_.box(input_);
    Handle handle;
    trace("insert ", key, text(box));
    if (!call(!live(key) && box.valid(), [&] { handle = engine_->insert(key, box); })) return;
    note_insert(key, box, handle);
    check_unchanged();
  }
  void insert_with_margin() {
    const Key key = some_key(true);
    const BoxType box = boxes_.box(input_);
    const double own = margin(input_);
    Handle handle;
    trace("insert ", key, text(box), ", margin ", own);
    const bool good = !live(key) && box.valid() && good_margin(own);
    if (!call(good, [&] { handle = engine_->insert(key, box, own); })) return;
    note_insert(key, box, handle);
    check_unchanged();
  }
  void insert_many() {
    const std::size_t count = input_.below(12);
    const bool one_less = input_.below(32) == 31;
    std::vector<Key> keys;
    std::vector<BoxType> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      Key key = some_key(true);
      // Mostly without a key twice.
      const std::size_t start = static_cast<std::size_t>(std::find(keys_.begin(), keys_.end(), key) - keys_.begin());
      for (std::size_t n = 1; n < kKeys && i % 8 != 7 && (contains(keys, key) || live(key)); ++n) {
        key = keys_[(start + n) % kKeys];
      }
      keys.push_back(key);
      boxes.push_back(boxes_.box(input_));
      trace("  of many: insert ", keys.back(), text(boxes.back()));
    }
    if (one_less && !boxes.empty()) boxes.pop_back();
    bool good = keys.size() == boxes.size();
    for (std::size_t i = 0; i < count && good; ++i) {
      good =
          boxes[i].valid() && !live(keys[i]) && std::find(keys.begin(), keys.begin() + i, keys[i]) == keys.begin() + i;
    }
    std::vector<Handle> handles;
    trace("insert many: ", count);
    if (!call(good, [&] { handles = engine_->insert(std::span<const Key>(keys), std::span<const BoxType>(boxes)); })) {
      return;
    }
    require(handles.size() == count, "another number of handles than of keys");
    for (std::size_t i = 0; i < count; ++i) note_insert(keys[i], boxes[i], handles[i]);
    check_unchanged();
  }

  void update_by_key() {
    const Key key = some_key(false);
    const BoxType box = boxes_.box(input_);
    trace("update ", key, text(box));
    if (call(live(key) && box.valid(), [&] { engine_->update(key, box); })) updated(key, box);
  }
  void update_by_handle() {
    const Handle handle = some_handle();
    const BoxType box = boxes_.box(input_);
    const Key* const key = key_of(handle);
    trace("update ", text(handle), text(box));
    if (call(key != nullptr && box.valid(), [&] { engine_->update(handle, box); })) updated(*key, box);
  }
  void update_ahead() {
    const Handle handle = some_handle();
    const BoxType box = boxes_.box(input_);
    typename EngineType::Displacement by;
    bool finite = true;
    for (double& on_axis : by) {
      on_axis = ahead(input_);
      finite = finite && std::isfinite(on_axis);
    }
    const Key* const key = key_of(handle);
    trace("update ", text(handle), text(box), ", ahead by ", by[0], " ...");
    const bool good = key != nullptr && box.valid() && finite && config_.envelope && config_.envelope->swept;
    if (call(good, [&] { engine_->update(handle, box, by); })) updated(*key, box);
  }
  void update_many() {
    const std::size_t count = input_.below(12);
    const bool one_less = input_.below(32) == 31;
    std::vector<Handle> handles;
    std::vector<BoxType> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      handles.push_back(some_handle());
      boxes.push_back(boxes_.box(input_));
      trace("  of many: update ", text(handles.back()), text(boxes.back()));
    }
    if (one_less && !boxes.empty()) boxes.pop_back();
    bool good = handles.size() == boxes.size();
    for (std::size_t i = 0; i < count && good; ++i) good = boxes[i].valid() && key_of(handles[i]) != nullptr;
    trace("update many: ", count);
    const auto body = [&] { engine_->update(std::span<const Handle>(handles), std::span<const BoxType>(boxes)); };
    if (!call(good, body)) return;
    for (std::size_t i = 0; i < count; ++i) model_.update(*key_of(handles[i]), expected_box(boxes[i]));
    check_unchanged();
  }

  void erase_by_key() {
    const Key key = some_key(false);
    trace("erase ", key);
    if (call(live(key), [&] { engine_->erase(key); })) erased(key);
  }
  void erase_by_handle() {
    const Handle handle = some_handle();
    const Key* const key = key_of(handle);
    trace("erase ", text(handle));
    if (call(key != nullptr, [&] { engine_->erase(handle); })) erased(Key(*key));
  }
  void erase_many() {
    const std::size_t count = input_.below(12);
    std::vector<Handle> handles;
    for (std::size_t i = 0; i < count; ++i) {
      Handle handle = some_handle();
      // Mostly without one twice.
      for (auto next = handles_.begin(); next != handles_.end() && contains(handles, handle) && i % 8 != 7; ++next) {
        handle = next->second;
      }
      handles.push_back(handle);
      trace("  of many: erase ", text(handle));
    }
    bool good = true;
    for (std::size_t i = 0; i < count; ++i) {
      const bool twice = std::find(handles.begin(), handles.begin() + i, handles[i]) != handles.begin() + i;
      good = good && !twice && key_of(handles[i]) != nullptr;
    }
    trace("erase many: ", count);
    if (!call(good, [&] { engine_->erase(std::span<const Handle>(handles)); })) return;
    for (const Handle handle : handles) note_erase(Key(*key_of(handle)));
    check_unchanged();
  }

  void set_margin() {
    const Handle handle = some_handle();
    const double own = margin(input_);
    trace("set_margin ", text(handle), " ", own);
    call(key_of(handle) != nullptr && good_margin(own), [&] { engine_->set_margin(handle, own); });
  }

  // ---- other calls

  void set_step_bytes() {
    config_.step_bytes = step_bytes(input_);
    trace("set_step_bytes ", config_.step_bytes ? std::to_string(*config_.step_bytes) : "-");
    engine_->set_step_bytes(config_.step_bytes);
  }

  /// Of the next call.
  void plan_failure() {
    const std::uint8_t mode = input_.byte();
    plan_ = {.first = input_.byte(), .count = mode % 2 == 0 ? 1 : heap::Failing::kAllAfter, .each = (mode & 2U) != 0};
    if (plan_.each) plan_.first = 0;
    // oneTBB's own allocations must not fail.
    if (config_.executor->concurrency() > 1) plan_ = {};
    if (plan_.count > 0) {
      trace("without memory, ", plan_.each ? "at each allocation in turn" : "from allocation ", plan_.first,
            plan_.count == 1 ? ", one fails" : ", all fail");
    }
  }

  void ask_for_pairs() {
    if (cells_lost_) return;
    std::vector<Pair<Key>> pairs;
    trace("pairs");
    if (call(true, [&] { pairs = engine_->pairs(); })) require_same("pairs", pairs_, pairs);
  }

  void step() {
    const Events<Key>* events = nullptr;
    trace("step");
    in_step_ = true;
    const bool returned = call(true, [&] { events = &engine_->step(); });
    in_step_ = false;
    if (!returned) return;
    cells_lost_ = false;
    latest_ = events;
    events_ = *events;
    if (engine_->status() == StepStatus::kOverBudget) {
      trace("  refused");
      require(config_.step_bytes.has_value(), "a step is over a budget that nobody set");
      require(events->begins.empty() && events->ends.empty(), "a refused step has events");
      check_unchanged();
      return;
    }
    Events<Key> expected = model_.step();
    if (planted("pair") && !expected.begins.empty()) expected.begins.pop_back();
    if (config_.envelope) {
      compare_with_envelopes(expected);
    } else {
      require_same(oracle::difference(expected, *events));
      require_same(oracle::compare(*engine_, model_));
    }
    pairs_ = engine_->pairs();
    const Stats stats = engine_->stats();
    require(stats.objects == handles_.size(), "stats() has another number of objects");
    require(stats.pairs == pairs_.size(), "stats() has another number of pairs");
    require(stats.step.begins == events->begins.size(), "stats() has another number of begins");
    require(stats.step.ends == events->ends.size(), "stats() has another number of ends");
    check_unchanged();
  }

  // Not `requires`: clang 14 instantiates what that rules out, too.
  void compare_with_envelopes(const Events<Key>& expected) {
    if constexpr (kTellsEnvelopes) {
      const EnvelopeOptions& options = *config_.envelope;
      const bool always = options.stride == 1 || options.on_violation == OnViolation::kQuery;
      if (options.exact && (always || engine_->envelope_report().violations == 0)) {
        require_same(oracle::difference(expected, events_));
      }
      require_same(listener_.hear(events_));
      require_same(oracle::compare_envelopes(options, *engine_, model_, listener_));
    }
  }

  // ---- making a call, and what must be true after it

  /// Makes a call that is to be refused unless `good`, perhaps without memory. Returns whether it was carried out.
  template <class Body>
  bool call(bool good, const Body& body) {
    Plan plan = std::exchange(plan_, {});
    for (std::uint64_t tries = 0;; ++tries, ++plan.first) {
      const Outcome outcome = attempt(plan, body);
      if (outcome == Outcome::kNoMemory) {
        trace("  no memory");
        check_unchanged();
        if (plan.each && tries < kMostTries) continue;
        return false;
      }
      if (outcome == Outcome::kRefused) trace("  refused");
      require(good || outcome == Outcome::kRefused, "bad input is taken");
      require(!good || outcome == Outcome::kDone, "good input is refused: " + refusal_);
      if (!good) check_unchanged();
      return good;
    }
  }

  enum class Outcome { kDone, kRefused, kNoMemory };

  template <class Body>
  Outcome attempt(const Plan& plan, const Body& body) {
    bool failed = false;
    try {
      const heap::Failing memory(plan.first, plan.count, heap::Failing::Of::kThisThread);
      try {
        body();
        return Outcome::kDone;
      } catch (...) {
        failed = memory.failed() > 0;
        throw;
      }
    } catch (const std::bad_alloc&) {
      require(failed, "std::bad_alloc, though there was memory");
      // Then there may have been none for the cells either.
      if (in_step_) cells_lost_ = true;
      if (in_step_) latest_ = nullptr;
      return Outcome::kNoMemory;
    } catch (const std::invalid_argument& error) {
      refusal_ = error.what();
      return Outcome::kRefused;
    }
  }

  void check_unchanged() const {
    require(engine_->size() == handles_.size(), "size() is wrong");
    for (const Key& key : keys_) {
      const auto own = handles_.find(key);
      require(engine_->contains(key) == (own != handles_.end()), "contains() is wrong");
      const std::optional<Handle> found = engine_->find(key);
      require(found.has_value() == (own != handles_.end()), "find() is wrong");
      if (!found) continue;
      require(*found == own->second, "find() gives another handle than insert()");
      require(engine_->key(*found) == key, "key() is wrong");
      require(engine_->box(*found) == model_.boxes().at(key), "box() is wrong");
    }
    if (latest_ != nullptr) require_same(oracle::difference(events_, *latest_));
    try {
      require_same("pairs", pairs_, engine_->pairs());
    } catch (const Finding&) {
      throw;
    } catch (const std::logic_error&) {
      require(cells_lost_, "pairs() throws, though the latest step had memory");
    }
  }

  static void require_same(const char* what, const std::vector<Pair<Key>>& expected,
                           const std::vector<Pair<Key>>& found) {
    require_same(oracle::difference(what, expected, found));
  }
  static void require_same(const std::string& difference) { require(difference.empty(), difference); }

  [[nodiscard]] bool good_margin(double own) const { return config_.envelope && own >= 0 && std::isfinite(own); }

  void note_insert(const Key& key, const BoxType& box, Handle handle) {
    require(key_of(handle) == nullptr, "a handle that is in use");
    handles_[key] = handle;
    issued_.push_back(handle);
    model_.insert(key, expected_box(box));
  }
  void updated(const Key& key, const BoxType& box) {
    model_.update(key, expected_box(box));
    check_unchanged();
  }
  void note_erase(const Key& key) {
    handles_.erase(key);
    model_.erase(key);
  }
  void erased(const Key& key) {
    note_erase(key);
    check_unchanged();
  }
  static BoxType expected_box(BoxType box) {
    if (planted("bit") && box.max[0] < std::numeric_limits<Scalar>::max()) {
      if constexpr (std::is_floating_point_v<Scalar>) {
        box.max[0] = std::nextafter(box.max[0], std::numeric_limits<Scalar>::max());
      } else {
        ++box.max[0];
      }
    }
    return box;
  }

  template <class List, class Item>
  static bool contains(const List& list, const Item& item) {
    return std::find(list.begin(), list.end(), item) != list.end();
  }

  // ---- the program in words, for people

  template <class... Parts>
  static void trace(const Parts&... parts) {
    static const bool wanted = std::getenv("SWEEPGRID_FUZZ_TRACE") != nullptr;
    if (wanted) ((std::cerr << parts), ..., (std::cerr << '\n'));
  }
  static std::string text(Handle handle) {
    return "handle " + std::to_string(handle.index) + "." + std::to_string(handle.generation);
  }
  static std::string text(const BoxType& box) {
    std::ostringstream out;
    out.precision(std::numeric_limits<Scalar>::max_digits10);
    for (int axis = 0; axis < Dim; ++axis) out << " [" << +box.min[axis] << ", " << +box.max[axis] << "]";
    return out.str();
  }

  Config config_;
  BoxMaker<Scalar, Dim> boxes_;
  Input& input_;
  std::unique_ptr<EngineType> engine_;
  Model model_;
  oracle::Listener listener_;
  std::vector<Key> keys_;
  std::map<Key, Handle> handles_;  // of live objects
  std::vector<Handle> issued_;     // all that were ever given out
  std::vector<Pair<Key>> pairs_;   // as of the latest step that was done
  Events<Key> events_;             // of the latest step
  const Events<Key>* latest_ = nullptr;
  Plan plan_;
  bool in_step_ = false;
  bool cells_lost_ = false;  // the latest step had no memory, and perhaps no cells are left
  std::string refusal_;
};

extern template class EngineProgram<float, 2>;
extern template class EngineProgram<float, 3>;
extern template class EngineProgram<double, 2>;
extern template class EngineProgram<double, 3>;
extern template class EngineProgram<std::int32_t, 2>;
extern template class EngineProgram<std::int32_t, 3>;
extern template class EngineProgram<std::int16_t, 2>;
extern template class EngineProgram<std::int16_t, 3>;
extern template class EngineProgram<float, 3, TextKey, TextKeyHash>;

}  // namespace sweepgrid::fuzz
