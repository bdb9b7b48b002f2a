// A small oracle test of the engine, quick to compile: `run` builds it anew for every planted bug.
// Exits with 1 and prints the name of each broken invariant when it notices something.

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/engine/engine_core.inl.hpp>

#include "op_script.hpp"

namespace sweepgrid {

template class EngineCore<float, 2>;

namespace {

using TestEngine = Engine<float, 2, std::uint32_t>;
using KeyPair = std::pair<std::uint32_t, std::uint32_t>;

/// A client that believes the events, and a list of boxes that knows better.
class Client {
 public:
  void queue(TestEngine& engine, const oracle::Drain<float, 2>& ops) {
    for (const auto& op : ops) {
      if (op.kind == OpKind::kErase) {
        engine.erase(op.object);
        boxes_.erase(op.object);
        continue;
      }
      if (op.kind == OpKind::kInsert) {
        engine.insert(op.object, op.box);
      } else {
        engine.update(op.object, op.box);
      }
      boxes_.insert_or_assign(op.object, op.box);
    }
  }

  /// The name of a broken invariant and what broke it; empty if all is well. "oracle": no event tells of a change.
  std::string hear(const Events<std::uint32_t>& events) {
    const auto less = [](const auto& a, const auto& b) { return key_pair(a) < key_pair(b); };
    for (const auto* list : {&events.ends, &events.begins}) {
      const auto unordered =
          std::adjacent_find(list->begin(), list->end(), [&](const auto& a, const auto& b) { return !less(a, b); });
      if (unordered != list->end()) return "E3: not sorted and unique at " + text(key_pair(*unordered));
    }
    for (const auto& pair : events.ends) {
      if (known_.erase(key_pair(pair)) == 0) return "E2: an end without a begin: " + text(key_pair(pair));
    }
    for (const auto& pair : events.begins) {
      if (!known_.insert(key_pair(pair)).second) return "E2: begun twice: " + text(key_pair(pair));
    }
    std::set<KeyPair> truth;
    for (auto a = boxes_.begin(); a != boxes_.end(); ++a) {
      for (auto b = std::next(a); b != boxes_.end(); ++b) {
        if (a->second.overlaps(b->second)) truth.emplace(a->first, b->first);
      }
    }
    return truth == known_ ? "" : "oracle: the events do not lead to the overlaps of the boxes";
  }

 private:
  static KeyPair key_pair(const Pair<std::uint32_t>& pair) { return {pair.first, pair.second}; }
  static std::string text(const KeyPair& pair) {
    return "(" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + ")";
  }

  std::map<std::uint32_t, Box<float, 2>> boxes_;
  std::set<KeyPair> known_;
};

int probe(const Config<float, 2>& config, const oracle::Regime& regime) {
  oracle::OpScript<float, 2> script(regime, 1);
  TestEngine engine(config);
  Client client;
  int status = 0;
  for (int step = 0; step < regime.drains && status == 0; ++step) {
    const auto note = [&](const std::string& finding) {
      if (status == 0) std::cout << "regime " << regime.name << ", step " << step << '\n';
      std::cout << finding << '\n';
      status = 1;
    };
    try {
      client.queue(engine, script.next());
      const std::string finding = client.hear(engine.step());
      if (!finding.empty()) note(finding);
    } catch (const std::exception& error) {
      note(error.what());
    }
    // Said beside the client's finding: one names the invariant, the other sees from outside that events are wrong.
    try {
      engine.validate();
    } catch (const std::exception& error) {
      note(error.what());
    }
  }
  return status;
}

}  // namespace
}  // namespace sweepgrid

int main() {
  using namespace sweepgrid;
  Config<float, 2> derived;
  derived.threads = 1;
  derived.cell_population = 8;
  Config<float, 2> fixed = derived;
  fixed.cell_size = 500;
  fixed.bounds = Box<float, 2>({-3000, -3000}, {3000, 3000});
  Config<float, 2> crowded = fixed;
  crowded.cell_size = 2;
  crowded.bounds = Box<float, 2>({-5, -5}, {5, 5});
  int status = 0;
  for (const oracle::Regime& regime : oracle::kRegimes) {
    for (const Config<float, 2>* config : {&derived, &fixed, &crowded}) {
      const bool lattice = regime.palette != oracle::Palette::kFine;
      if (config != &derived && lattice != (config == &crowded)) continue;
      status |= probe(*config, regime);
    }
    if (status != 0) break;
  }
  return status;
}
