#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baselines/peer_system.hpp"
#include "scenes/scene_script.hpp"

namespace sweepgrid::accuracy {

/// What a method's pairs are to those of T0, for valid boxes.
enum class Claim { kExact, kSuperset };

/// A broad phase that takes part in studies: how it is made, and what it claims of itself.
struct Method {
  std::string name;
  std::string about;
  Claim claim = Claim::kExact;
  /// Boxes with a NaN or min > max are refused by queue() with std::invalid_argument.
  bool refuses_bad_input = false;
  /// A system for the objects and the world of a script, which may use so many bytes of memory. One thread.
  std::function<std::unique_ptr<baselines::System>(const SceneScript&, std::uint64_t bytes)> make;
};

/// Every kind of cell by itself ("cell/classic") and in the grid ("grid/classic"), the engine as it configures itself
/// ("engine"), the dynamic octree ("octree"), and, as far as they were there when this was built, "bullet/dbvt",
/// "bullet/axis16", "bullet/axis32" and "fcl".
[[nodiscard]] const std::vector<Method>& methods();

/// Absent when there is none of that name.
[[nodiscard]] std::optional<Method> find_method(std::string_view name);

}  // namespace sweepgrid::accuracy
