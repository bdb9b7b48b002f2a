#include "accuracy/methods.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <sweepgrid/engine/config.hpp>

#include "accuracy/cell_system.hpp"
#include "accuracy/engine_system.hpp"
#include "accuracy/octree_system.hpp"
#include "baselines/peer_bullet.hpp"
#include "baselines/peer_fcl.hpp"

namespace sweepgrid::accuracy {
namespace {

struct NamedKind {
  const char* name;
  CellKind kind;
};
constexpr NamedKind kKinds[] = {{"classic", CellKind::kClassic},
                                {"batch", CellKind::kBatch},
                                {"segmented", CellKind::kSegmented},
                                {"rows", CellKind::kRows},
                                {"plane", CellKind::kPlane}};

Config on_one_thread(CellKind kind) {
  Config config;
  config.cell.kind = kind;
  config.threads = 1;
  return config;
}

Method engine_method(const std::string& name, const std::string& about, CellKind kind) {
  return {name, about, Claim::kExact, true, [kind](const SceneScript& script, std::uint64_t bytes) {
            Config config = on_one_thread(kind);
            config.step_bytes = bytes / 4;  // lists double as they grow
            return std::make_unique<EngineSystem>(config, false, script.objects);
          }};
}

#ifdef SWEEPGRID_WITH_BULLET
// Around all finite coordinates that the script ever names; who has Bullet's sweep must know it beforehand.
FloatBox world_of(const SceneScript& script) {
  constexpr float kMost = std::numeric_limits<float>::max();
  FloatBox world({kMost, kMost, kMost}, {-kMost, -kMost, -kMost});
  const auto take = [&world](const std::vector<FloatBox>& boxes) {
    for (const FloatBox& box : boxes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const float value : {box.min[axis], box.max[axis]}) {
          if (!std::isfinite(value)) continue;
          world.min[axis] = std::min(world.min[axis], value);
          world.max[axis] = std::max(world.max[axis], value);
        }
      }
    }
  };
  for (const ScriptStep& step : script.steps) {
    take(step.inserted_boxes);
    take(step.updated_boxes);
  }
  // An axis on which nothing differs would have no step between two numbers.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(world.min[axis] < world.max[axis])) world.max[axis] = std::nextafter(world.min[axis], kMost) + 1;
  }
  return world;
}

// The most objects that there are at any time; in a step, some go before others come.
std::uint32_t most_at_once(const SceneScript& script) {
  std::size_t now = 0;
  std::size_t most = 0;
  for (const ScriptStep& step : script.steps) {
    now += step.inserted.size();
    now -= step.erased.size();
    most = std::max(most, now);
  }
  return static_cast<std::uint32_t>(most);
}

Method axis_sweep(const char* name, const char* about, baselines::AxisSweepBits bits) {
  return {name, about, Claim::kSuperset, false, [bits](const SceneScript& script, std::uint64_t) {
            return baselines::make_bullet_axis_sweep(bits, world_of(script), script.objects, most_at_once(script));
          }};
}
#endif

std::vector<Method> make_methods() {
  std::vector<Method> methods;
  for (const auto& [name, kind] : kKinds) {
    methods.push_back({std::string("cell/") + name, "one cell over everything", Claim::kExact, false,
                       [options = CellOptions{kind}](const SceneScript&, std::uint64_t) {
                         return std::make_unique<CellSystem>(options);
                       }});
  }
  for (const auto& [name, kind] : kKinds) {
    methods.push_back(engine_method(std::string("grid/") + name, "the engine with cells of this kind alone", kind));
  }
  methods.push_back(engine_method("engine", "the engine as it configures itself", CellKind::kRows));
  methods.push_back({"octree", "dynamic octree, the paper's baseline", Claim::kExact, true,
                     [](const SceneScript&, std::uint64_t) { return std::make_unique<OctreeSystem>(); }});
#ifdef SWEEPGRID_WITH_BULLET
  methods.push_back({"bullet/dbvt", "btDbvtBroadphase, exact boxes", Claim::kExact, false,
                     [](const SceneScript& script, std::uint64_t) { return baselines::make_bullet(script.objects); }});
  methods.push_back(axis_sweep("bullet/axis16", "btAxisSweep3, 16 bits per coordinate", baselines::AxisSweepBits::k16));
  methods.push_back(
      axis_sweep("bullet/axis32", "bt32BitAxisSweep3, 32 bits per coordinate", baselines::AxisSweepBits::k32));
#endif
#ifdef SWEEPGRID_WITH_FCL
  methods.push_back({"fcl", "DynamicAABBTreeCollisionManager, moved leaves updated", Claim::kExact, false,
                     [](const SceneScript& script, std::uint64_t) {
                       return baselines::make_fcl(baselines::FclUpkeep::kUpdate, script.objects);
                     }});
#endif
  return methods;
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all = make_methods();
  return all;
}

std::optional<Method> find_method(std::string_view name) {
  const auto found =
      std::find_if(methods().begin(), methods().end(), [name](const Method& method) { return method.name == name; });
  if (found == methods().end()) return std::nullopt;
  return *found;
}

}  // namespace sweepgrid::accuracy
