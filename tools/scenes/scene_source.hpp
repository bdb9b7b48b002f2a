#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/sap/box.hpp>

#include "scenes/oriented_box.hpp"

namespace sweepgrid {

/// Number that a scene gives an object. Files keep theirs; a key whose object is gone may come back.
using SceneKey = std::uint64_t;

/// What the objects are that the boxes bound. Spheres are inscribed in their boxes (circles, in two dimensions).
enum class ShapeKind { kBoxes, kSpheres, kOrientedBoxes };

/// What changes from one step to the next. Keys are distinct within the whole struct, and the three parts may be
/// applied in any order.
struct SceneStep {
  std::vector<SceneKey> erased;
  std::vector<SceneKey> inserted;
  std::vector<SceneBox> inserted_boxes;  ///< of inserted[i]
  std::vector<SceneKey> updated;         ///< lived on, with a box that differs from the last one
  std::vector<SceneBox> updated_boxes;   ///< of updated[i]
  /// Of inserted[i] and of updated[i] where the objects are oriented boxes; else empty.
  std::vector<OrientedBox> inserted_shapes;
  std::vector<OrientedBox> updated_shapes;

  void clear() {
    erased.clear();
    inserted.clear();
    inserted_boxes.clear();
    updated.clear();
    updated_boxes.clear();
    inserted_shapes.clear();
    updated_shapes.clear();
  }
};

/// What is known of a scene before it is read.
struct SceneInfo {
  std::string name;                                          ///< as it was asked for: path or generator with parameters
  std::string format;                                        ///< "aabbs", "lammps" or "generator"
  std::string compression;                                   ///< "none", "gzip", "xz" or "zstd"
  int dim = 3;                                               ///< 2 or 3
  ShapeKind shapes = ShapeKind::kBoxes;                      ///< what the boxes bound, as far as it is known
  std::optional<SceneBox> bounds;                            ///< the world as the scene tells it; boxes may stick out
  std::optional<std::uint64_t> steps;                        ///< after the start
  std::vector<std::pair<std::string, std::string>> details;  ///< more, by format: name and value
};

/// A scene as a stream: the start, which inserts the first objects, and then one SceneStep at a time.
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  [[nodiscard]] virtual const SceneInfo& info() const = 0;

  /// Replaces `step` by the next one; false at the end. Every scene has a start. Memory is that of two frames.
  /// Throws SceneError for a truncated or malformed file; the source is of no more use then.
  virtual bool next(SceneStep& step) = 0;
};

}  // namespace sweepgrid
