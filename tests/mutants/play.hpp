#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "client.hpp"
#include "scene_script.hpp"

/// What the probes that play scenes share.
namespace sweepgrid {

using TestEngine = Engine<float, 2>;
using Ops = oracle::EngineOps<float, 2>;

inline void queue(TestEngine& engine, Client& client, const Ops& ops) {
  for (const auto& op : ops) {
    if (op.kind == OpKind::kErase) {
      engine.erase(op.key);
      client.erase(op.key);
      continue;
    }
    if (op.kind == OpKind::kInsert) {
      engine.insert(op.key, op.box);
    } else {
      engine.update(op.key, op.box);
    }
    client.set(op.key, op.box);
  }
}

/// Steps and says what is wrong, if anything: what the client finds and what validate() does. One names the invariant,
/// the other sees from outside that events are wrong.
inline std::vector<std::string> step(TestEngine& engine, Client& client, const Ops& ops) {
  std::vector<std::string> findings;
  try {
    queue(engine, client, ops);
    const std::string finding = client.hear(engine.step());
    if (!finding.empty()) findings.push_back(finding);
  } catch (const std::exception& error) {
    return {text_of(error)};  // an engine that has thrown can but be destroyed
  }
  try {
    engine.validate();
  } catch (const std::exception& error) {
    findings.push_back(text_of(error));
  }
  return findings;
}

inline int report(const char* scene, int step, const std::vector<std::string>& findings) {
  std::cout << "scene " << scene << ", step " << step << '\n';
  for (const std::string& finding : findings) std::cout << finding << '\n';
  return 1;
}

/// What a scene does next.
using Script = std::function<Ops()>;

/// `done`: to be told of the engine after each step.
inline int probe(
    const Config& config, const char* scene, const Script& script, int steps,
    const std::function<void(const TestEngine&)>& done = [](const TestEngine&) {}) {
  TestEngine engine(config);
  Client client;
  for (int number = 0; number < steps; ++number) {
    const auto findings = step(engine, client, script());
    if (!findings.empty()) return report(scene, number, findings);
    done(engine);
  }
  return 0;
}

inline int probe_scene(const Config& config, const oracle::SceneRegime& regime) {
  oracle::SceneScript<float, 2> script(regime, 1);
  return probe(
      config, regime.name, [&] { return script.next(); }, regime.steps);
}

/// Steps are refused now and then, some of them several times.
inline int probe_refusals(const Config& config, const char* scene, const Script& script, int steps) {
  TestEngine engine(config);
  Client client;
  oracle::Random random(1);
  std::size_t pairs = 0;
  for (int number = 0; number < steps; ++number) {
    try {
      queue(engine, client, script());
      const int tries = random.below(3);
      for (int i = 0; i < tries; ++i) {
        engine.set_step_bytes(std::uint64_t{1} << random.below(12));
        const auto& events = engine.step();
        std::string finding;
        if (engine.status() == StepStatus::kDone) {
          finding = client.hear(events);
          pairs = engine.pairs().size();
        } else if (!events.begins.empty() || !events.ends.empty() || engine.pairs().size() != pairs) {
          finding = "refused: a step that was refused has left something behind";
        }
        if (!finding.empty()) return report(scene, number, {finding});
      }
    } catch (const std::exception& error) {
      return report(scene, number, {text_of(error)});
    }
    engine.set_step_bytes(std::nullopt);
    if (number % 2 == 0) continue;
    const auto findings = step(engine, client, {});
    if (!findings.empty()) return report(scene, number, findings);
    pairs = engine.pairs().size();
  }
  return 0;
}

inline int probe_refusals(const Config& config, const oracle::SceneRegime& regime) {
  oracle::SceneScript<float, 2> script(regime, 1);
  return probe_refusals(
      config, regime.name, [&] { return script.next(); }, regime.steps);
}

}  // namespace sweepgrid
