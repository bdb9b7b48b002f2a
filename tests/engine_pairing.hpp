#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <sweepgrid/engine/engine.hpp>

#include "engine_model.hpp"

namespace sweepgrid::oracle {

/// An engine beside the model.
template <class Scalar, int Dim>
struct Pairing {
  using BoxType = Box<Scalar, Dim>;

  explicit Pairing(const Config& config) : engine(config) {}

  void put(std::uint64_t key, const BoxType& box) {
    if (engine.contains(key)) {
      engine.update(key, box);
      model.update(key, box);
    } else {
      engine.insert(key, box);
      model.insert(key, box);
    }
  }
  void erase(std::uint64_t key) {
    engine.erase(key);
    model.erase(key);
  }
  // Returns what is wrong.
  std::string step() {
    events = &engine.step();
    const std::string wrong = oracle::difference(model.step(), *events);
    return wrong.empty() ? oracle::compare(engine, model) : wrong;
  }

  Engine<Scalar, Dim> engine;
  EngineModel<Scalar, Dim> model;
  const Events<std::uint64_t>* events = nullptr;  // of the latest step
};

/// An object without a box before the step, or after it, meets nobody there, not even who is everywhere.
template <class Scalar>
void meet_everywhere() {
  using Limits = std::numeric_limits<Scalar>;
  const Scalar least = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  const Scalar most = Limits::has_infinity ? Limits::infinity() : Limits::max();
  Config config;
  config.step_method = StepMethod::kSweep;
  config.threads = 1;
  Pairing<Scalar, 2> scene(config);
  for (std::uint64_t key = 0; key < 40; ++key) {
    scene.put(key, {{least, least}, {most, most}});
    ASSERT_EQ(scene.step(), "");
    EXPECT_EQ(scene.events->begins.size(), key);
  }
  for (std::uint64_t key = 0; key < 40; ++key) {
    scene.erase(key);
    scene.put(key + 100, {{least, least}, {least, least}});
    ASSERT_EQ(scene.step(), "");
    EXPECT_EQ(scene.events->ends.size(), 39u);
  }
}

}  // namespace sweepgrid::oracle
