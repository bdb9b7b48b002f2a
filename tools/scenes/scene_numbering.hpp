#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// Numbers the objects of a scene densely, in the order of their first appearance.
class SceneNumbering {
 public:
  [[nodiscard]] std::vector<std::uint32_t> numbers(const std::vector<SceneKey>& keys) {
    std::vector<std::uint32_t> result;
    result.reserve(keys.size());
    for (const SceneKey key : keys) {
      result.push_back(numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second);
    }
    return result;
  }

  /// Numbers given so far.
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(numbers_.size()); }

 private:
  std::unordered_map<SceneKey, std::uint32_t> numbers_;
};

}  // namespace sweepgrid
