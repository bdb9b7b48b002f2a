#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/open_scene.hpp"

namespace sweepgrid::scene_files {

/// Of every bit that a scene gives, step by step.
inline std::uint64_t fingerprint(const std::string& spec) {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  const auto take = [&hash](std::uint64_t value) {
    for (int i = 0; i < 8; ++i) hash = (hash ^ (value >> (8 * i) & 0xff)) * 1099511628211U;
  };
  const auto take_boxes = [&](const std::vector<SceneKey>& keys, const std::vector<SceneBox>& boxes) {
    take(keys.size());
    for (const SceneKey key : keys) take(key);
    for (const SceneBox& box : boxes) {
      for (const double x : box.min) take(std::bit_cast<std::uint64_t>(x));
      for (const double x : box.max) take(std::bit_cast<std::uint64_t>(x));
    }
  };
  const auto source = open_scene(spec);
  for (SceneStep step; source->next(step);) {
    take_boxes(step.erased, {});
    take_boxes(step.inserted, step.inserted_boxes);
    take_boxes(step.updated, step.updated_boxes);
  }
  return hash;
}

}  // namespace sweepgrid::scene_files
