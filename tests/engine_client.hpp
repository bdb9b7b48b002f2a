#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine_oracle.hpp"

/// What the tests of the public interface share.
namespace sweepgrid {

using Engine2 = Engine<float, 2>;
using Box2 = Box<float, 2>;
using Pairs = std::vector<Pair<std::uint64_t>>;

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

inline Config serial() {
  Config config;
  config.threads = 1;
  return config;
}

/// The same, and no step sweeps.
inline Config through_cells() {
  Config config = serial();
  config.step_method = StepMethod::kCells;
  return config;
}

inline Box2 square(float x, float y, float width = 1) { return Box2({x, y}, {x + width, y + width}); }

/// What the call says when it throws std::invalid_argument; fails when it does not.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

inline ::testing::AssertionResult has(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << text << "' does not say '" << part << "'";
}

}  // namespace sweepgrid
