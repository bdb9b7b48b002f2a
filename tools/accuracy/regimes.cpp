#include "accuracy/regimes.hpp"

#include <fmt/format.h>

namespace sweepgrid::accuracy {
namespace {

// All objects move, because at rest nothing is hard; slowly, so that a step resembles the one before.
constexpr std::string_view kCalm = "uniform:moving=1,churn=0,speed=0.01";

std::string calm_but(std::string_view parameters) { return fmt::format("{},{}", kCalm, parameters); }

// Of another speed.
std::string moving_but(std::string_view parameters) { return fmt::format("uniform:moving=1,churn=0,{}", parameters); }

std::vector<Regime> make_regimes() {
  const std::vector<std::string> shares = {"0", "0.01", "0.1", "0.5", "1"};
  return {
      {"speed", "Fast objects", "widths per step", moving_but("speed={}"), {"0.01", "0.1", "1", "10", "100"}},
      {"teleport", "Teleporting objects", "part that jumps per step", calm_but("teleport={}"), shares},
      {"wall",
       "Aligned on x",
       "layers of objects along x",
       calm_but("density=0.1,axis=0,layers={}"),
       {"0", "16", "4", "1"}},
      {"pile", "Aligned on z", "layers of objects along z", calm_but("density=0.1,layers={}"), {"0", "16", "4", "1"}},
      {"clusters",
       "Clusters",
       "deviation of four clusters, in edges of the world",
       calm_but("clusters=4,spread={}"),
       {"0.3", "0.1", "0.03", "0.01"}},
      {"covers", "Boxes over everything", "boxes that cover the world", calm_but("covers={}"), {"0", "1", "10", "100"}},
      {"sizes",
       "Sizes",
       "1 % of the objects are so many times as wide",
       calm_but("large=0.01,scale={}"),
       {"1", "10", "100", "1e3", "1e4"}},
      {"far",
       "Far from the origin",
       "widths from the origin",
       calm_but("offset={}"),
       {"0", "1e3", "1e4", "1e5", "1e6", "1e7", "1e8"}},
      {"lattice",
       "Touching lattices and ties",
       "boxes lie at multiples of so many widths",
       moving_but("density=0.3,speed=1,snap={}"),
       {"0", "1/64", "1/8", "1/2", "1"}},
      {"thin", "Without thickness", "thickness in widths", calm_but("thin={}"), {"1", "0.1", "0.01", "0"}},
      {"churn", "Coming and going", "part that is replaced per step", "uniform:moving=1,speed=0.01,churn={}", shares},
      {"crossing",
       "To and fro over borders",
       "widths to and fro in each step",
       moving_but("cross=1/16,speed={}"),
       {"0.01", "0.1", "1", "4", "16"}},
      {"point",
       "All at one point",
       "deviation from the point, in edges of the world",
       moving_but("clusters=1,speed=0.001,spread={}"),
       {"0.3", "0.1", "0.03", "0.01", "0"}},
      {"limits", "Limits of float", "width of an object", calm_but("width={}"), {"1", "1e10", "1e20", "1e30", "1e36"}},
      {"tiny", "Small numbers", "width of an object", calm_but("width={}"), {"1", "1e-10", "1e-20", "1e-30"}},
      {"infinite",
       "Infinite boxes",
       "part that reaches to infinity",
       calm_but("infinite={}"),
       {"0", "0.001", "0.01", "0.1"}},
      {"nan", "NaN", "part of the updates with a NaN", calm_but("nan={}"), {"0", "0.001", "0.01", "0.1"}},
      {"inverted",
       "Endpoints that invert",
       "part of the updates with min > max",
       calm_but("inverted={}"),
       {"0", "0.001", "0.01", "0.1"}},
  };
}

}  // namespace

const std::vector<Regime>& regimes() {
  static const std::vector<Regime> all = make_regimes();
  return all;
}

const Regime& memory_regime() {
  static const Regime regime = {"memory",
                                "All at one point, little memory",
                                "MB of memory",
                                moving_but("clusters=1,speed=0.001,spread=0"),
                                {"2048", "512", "128", "32", "8"}};
  return regime;
}

std::string scene_at(const Regime& regime, std::string_view value, std::uint64_t objects, std::uint64_t steps) {
  return fmt::format("{},n={},steps={}", fmt::format(fmt::runtime(regime.scene), value), objects, steps);
}

std::string calm_scene(std::uint64_t objects, std::uint64_t steps) {
  return fmt::format("{},n={},steps={}", kCalm, objects, steps);
}

}  // namespace sweepgrid::accuracy
