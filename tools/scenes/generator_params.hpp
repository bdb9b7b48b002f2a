#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepgrid {

/// What a generated scene is made of. Every generator knows all of them; they differ in their defaults.
struct GeneratorParams {
  std::uint64_t n = 100000;  ///< objects
  double moving = 0.1;       ///< part of the objects that moves; the others rest
  double churn = 0.005;      ///< part that is erased, and as many inserted, in each step
  double density = 0.05;     ///< volume (area) of all objects / that of the world
  double speed = 0.1;        ///< of a moving object, in widths per step
  double width = 1;          ///< edge of an object
  std::uint64_t seed = 1;
  std::uint64_t steps = 50;  ///< after the start
  std::uint64_t dim = 3;     ///< 2 or 3
  double large = 0;          ///< part of the objects that is `scale` times as wide
  double scale = 10;
  std::uint64_t clusters = 0;  ///< clumps in which objects appear; 0: anywhere
  double spread = 0.05;        ///< deviation of a clump from its centre, in edges of the world
  double layers = 0;           ///< extent of the world on `axis` in widths; 0: as on the other axes
  double teleport = 0;         ///< part of the moving objects that jumps anywhere in each step
  double offset = 0;           ///< of the world's corner from the origin, on every axis, in widths
  double jitter = 0;           ///< how far objects at rest shake about their places, in widths
  double turn = 0;             ///< more than 0: objects are oriented boxes; the moving ones turn by as many radians
  double snap = 0;             ///< more than 0: boxes lie at multiples of so many widths
  double cross = 0;            ///< more than 0: moving objects go to and fro over multiples of so many widths
  double thin = 1;             ///< thickness of objects on `axis`, in their widths
  std::uint64_t axis = 2;      ///< of layers, thin and infinite; in two dimensions at most 1
  std::uint64_t covers = 0;    ///< objects that cover the whole world, at rest
  double infinite = 0;         ///< part of the objects that reaches to infinity on one side of `axis`
  double nan = 0;              ///< part of the moving objects whose new box has a NaN, in each step: bad input
  double inverted = 0;         ///< part of the moving objects whose new box has min > max, in each step: bad input
};

/// The parameters that `spec` asks for, "NAME" or "NAME:key=value,key=value", on top of those of generator NAME; absent
/// when no generator is called so. A value is a number or a fraction such as 1/3000.
/// Throws SceneError that names the parameter when one is unknown, there twice, malformed or out of range.
[[nodiscard]] std::optional<GeneratorParams> parse_generator(std::string_view spec);

/// All parameters as "key", "value".
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe(const GeneratorParams& params);

/// The generators and the parameters, for a help text.
[[nodiscard]] std::string generator_help();

}  // namespace sweepgrid
