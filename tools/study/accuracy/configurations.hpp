#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sweepgrid/engine/envelope_options.hpp>

#include "accuracy/truth.hpp"
#include "setup/guarantee.hpp"
#include "setup/treatment.hpp"

namespace sweepgrid::study {

/// A setting of the engine that trades accuracy for time, or takes part in it.
struct Configuration {
  std::string name;
  Door door = Door::kDouble;
  std::optional<EnvelopeOptions> envelope = {};  ///< its margin is in widths of the scene's objects
};

/// Every knob alone, and combinations. The first is an exact engine in double, which the others are compared with.
[[nodiscard]] const std::vector<Configuration>& configurations();

/// Throws std::invalid_argument that names it when there is none of that name.
[[nodiscard]] const Configuration& find_configuration(std::string_view name);

/// What `configuration` promises of a truth after `violations` as of EnvelopeReport. T2: of shapes other than the
/// boxes.
[[nodiscard]] Guarantee guarantee(const Configuration& configuration, accuracy::TruthKind truth,
                                  std::uint64_t violations);

}  // namespace sweepgrid::study
