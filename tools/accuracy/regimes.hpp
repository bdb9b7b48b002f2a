#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sweepgrid::accuracy {

/// A way in which scenes become hard: a generated scene with one parameter, from where it does nothing, or nearly
/// nothing, to where methods break.
struct Regime {
  std::string id;  ///< [a-z-]+
  std::string title;
  std::string parameter;            ///< what the values are, with the unit
  std::string scene;                ///< generator and parameters; {} stands for the value
  std::vector<std::string> values;  ///< from calm to broken
};

/// Every regime of the stability map.
[[nodiscard]] const std::vector<Regime>& regimes();

/// All objects at one point, as many pairs as there can be, with less and less memory: the values are MB.
[[nodiscard]] const Regime& memory_regime();

/// The scene of a regime at one of its values.
[[nodiscard]] std::string scene_at(const Regime& regime, std::string_view value, std::uint64_t objects,
                                   std::uint64_t steps);

/// The same number of objects and steps without anything hard: what costs are relative to.
[[nodiscard]] std::string calm_scene(std::uint64_t objects, std::uint64_t steps);

}  // namespace sweepgrid::accuracy
