#include "scenes/generator_params.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

using Field = std::variant<double GeneratorParams::*, std::uint64_t GeneratorParams::*>;

struct Parameter {
  std::string_view key;
  Field field;
  double low;
  double high;
  std::string_view meaning;
};

constexpr double kMany = 0x1p32;
constexpr double kHuge = 1e30;
constexpr double kTiny = 1e-30;
const Parameter kParameters[] = {
    {"n", &GeneratorParams::n, 1, kMany, "objects"},
    {"moving", &GeneratorParams::moving, 0, 1, "part of the objects that moves"},
    {"churn", &GeneratorParams::churn, 0, 1, "part erased, and as many inserted, per step"},
    {"density", &GeneratorParams::density, 1e-9, 1e9, "volume of all objects / that of the world"},
    {"speed", &GeneratorParams::speed, 0, kHuge, "widths per step"},
    {"width", &GeneratorParams::width, kTiny, 1e38, "edge of an object"},
    {"seed", &GeneratorParams::seed, 0, 0x1p64, "of the random numbers"},
    {"steps", &GeneratorParams::steps, 0, 0x1p53, "after the start"},
    {"dim", &GeneratorParams::dim, 2, 3, "2 or 3"},
    {"large", &GeneratorParams::large, 0, 1, "part of the objects that is wider"},
    {"scale", &GeneratorParams::scale, 1e-6, 1e6, "how many times as wide those are"},
    {"clusters", &GeneratorParams::clusters, 0, kMany, "clumps in which objects appear, 0: anywhere"},
    {"spread", &GeneratorParams::spread, 0, 1, "deviation of a clump, in edges of the world"},
    {"layers", &GeneratorParams::layers, 0, 1e9, "height of the world in widths, 0: a cube"},
    {"teleport", &GeneratorParams::teleport, 0, 1, "part of the moving objects that jumps anywhere per step"},
    {"offset", &GeneratorParams::offset, 0, kHuge, "of the world from the origin, in widths"},
    {"jitter", &GeneratorParams::jitter, 0, kHuge, "how far objects at rest shake, in widths"},
    {"turn", &GeneratorParams::turn, 0, 1, "radians per step; above 0 objects are oriented boxes"},
    {"snap", &GeneratorParams::snap, 0, kHuge, "boxes lie at multiples of so many widths, 0: anywhere"},
    {"cross", &GeneratorParams::cross, 0, kHuge, "widths between borders that moving objects cross, 0: none"},
    {"thin", &GeneratorParams::thin, 0, kHuge, "thickness of objects on `axis`, in their widths"},
    {"axis", &GeneratorParams::axis, 0, 2, "of layers, thin and infinite; 2D: at most 1"},
    {"covers", &GeneratorParams::covers, 0, kMany, "objects that cover the whole world"},
    {"infinite", &GeneratorParams::infinite, 0, 1, "part of the objects that is infinite on one side of `axis`"},
    {"nan", &GeneratorParams::nan, 0, 1, "part of the moving objects with a NaN per step: bad input"},
    {"inverted", &GeneratorParams::inverted, 0, 1, "part of the moving objects with min > max per step: bad input"},
};

struct Generator {
  std::string_view name;
  std::string_view defaults;
  std::string_view meaning;
};
constexpr Generator kGenerators[] = {
    {"uniform", "", "the synthetic scene of the paper's section 4"},
    {"clusters", "clusters=16", "objects appear in gaussian clumps"},
    {"sizes", "large=0.01", "1 % of the objects are ten times as wide"},
    {"pile", "layers=4,density=0.3", "a thin layer of objects"},
    {"teleport", "teleport=1", "moving objects jump anywhere in every step"},
    {"fast", "n=10000,moving=1,churn=0,speed=2", "objects tunnel: two widths per step"},
    {"far", "n=10000,moving=1,churn=0,offset=1e6", "far from the origin"},
    {"resting", "n=10000,moving=0.01,churn=0,jitter=0.005", "objects shake at their places, few move"},
    {"turning", "n=10000,moving=1,churn=0,turn=0.05,density=0.3", "oriented boxes that fly and turn"},
    {"wall", "n=10000,moving=1,churn=0,layers=1,axis=0", "all objects at the same x"},
    {"lattice", "n=10000,moving=1,churn=0,snap=1,density=0.3,speed=1", "boxes touch and tie, all at whole widths"},
    {"plates", "n=10000,moving=1,churn=0,thin=0", "objects without thickness"},
    {"crossing", "n=10000,moving=1,churn=0,cross=4,speed=0.01", "objects go to and fro over cell borders"},
    {"point", "n=1000,moving=1,churn=0,clusters=1,spread=0,speed=0.001", "all objects at one point"},
    {"huge", "n=10000,moving=1,churn=0,width=1e36,infinite=0.01", "near the limits of float, with infinities"},
    {"bad", "n=1000,moving=1,churn=0,nan=0.01,inverted=0.01", "some boxes are bad input, to be refused"},
};

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// A number, or one divided by another.
std::optional<double> parse_value(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number(text);
  const auto above = parse_number(text.substr(0, slash));
  const auto below = parse_number(text.substr(slash + 1));
  if (!above || !below || *below == 0) return std::nullopt;
  return *above / *below;
}

[[noreturn]] void fail(std::string_view generator, std::string_view reason) {
  throw SceneError(fmt::format("generator {}: {}", generator, reason));
}

void set_parameter(std::string_view generator, const Parameter& parameter, std::string_view text,
                   GeneratorParams& params) {
  const auto value = parse_value(text);
  const auto bounds = [&] { return fmt::format("within {} and {}", parameter.low, parameter.high); };
  if (!value) fail(generator, fmt::format("parameter {}: '{}' is not a number {}", parameter.key, text, bounds()));
  if (*value < parameter.low || *value > parameter.high) {
    fail(generator, fmt::format("parameter {}: {} is not {}", parameter.key, text, bounds()));
  }
  // Divided by, smaller ones would be infinite.
  if (*value != 0 && std::abs(*value) < kTiny) {
    fail(generator, fmt::format("parameter {}: {} is neither 0 nor at least {}", parameter.key, text, kTiny));
  }
  if (const auto* real = std::get_if<double GeneratorParams::*>(&parameter.field)) {
    params.*(*real) = *value;
    return;
  }
  // Digits alone keep all 64 bits; a double such as 1e5 or 200000/2 is as good when it is whole.
  std::uint64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error != std::errc() || end != text.data() + text.size()) {
    if (*value != std::floor(*value) || *value >= 0x1p64) {
      fail(generator, fmt::format("parameter {}: {} is not a whole number below 2^64", parameter.key, text));
    }
    whole = static_cast<std::uint64_t>(*value);
  }
  params.*std::get<std::uint64_t GeneratorParams::*>(parameter.field) = whole;
}

void set_parameters(std::string_view generator, std::string_view list, GeneratorParams& params) {
  std::set<std::string_view> seen;
  while (!list.empty()) {
    const std::string_view item = list.substr(0, list.find(','));
    list.remove_prefix(std::min(item.size() + 1, list.size()));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) fail(generator, fmt::format("'{}' is not key=value", item));
    const std::string_view key = item.substr(0, equals);
    const auto parameter = std::find_if(std::begin(kParameters), std::end(kParameters),
                                        [&](const Parameter& candidate) { return candidate.key == key; });
    if (parameter == std::end(kParameters)) {
      std::vector<std::string_view> keys;
      for (const Parameter& known : kParameters) keys.push_back(known.key);
      fail(generator, fmt::format("no parameter '{}'; there are {}", key, fmt::join(keys, ", ")));
    }
    if (!seen.insert(key).second) fail(generator, fmt::format("parameter {} is there twice", key));
    set_parameter(generator, *parameter, item.substr(equals + 1), params);
  }
}

std::string value_text(const GeneratorParams& params, const Field& field) {
  return std::visit([&](auto member) { return fmt::format("{}", params.*member); }, field);
}

}  // namespace

std::optional<GeneratorParams> parse_generator(std::string_view spec) {
  const std::string_view name = spec.substr(0, spec.find(':'));
  const auto generator = std::find_if(std::begin(kGenerators), std::end(kGenerators),
                                      [&](const Generator& candidate) { return candidate.name == name; });
  if (generator == std::end(kGenerators)) return std::nullopt;
  GeneratorParams params;
  set_parameters(name, generator->defaults, params);
  if (spec.size() > name.size()) set_parameters(name, spec.substr(name.size() + 1), params);
  if (params.turn > 0 && (params.snap > 0 || params.thin != 1 || params.covers > 0 || params.infinite > 0)) {
    fail(name, "oriented boxes (turn) go with neither snap, thin, covers nor infinite");
  }
  return params;
}

std::vector<std::pair<std::string, std::string>> describe(const GeneratorParams& params) {
  std::vector<std::pair<std::string, std::string>> result;
  for (const Parameter& parameter : kParameters) {
    result.emplace_back(parameter.key, value_text(params, parameter.field));
  }
  return result;
}

std::string generator_help() {
  std::string text = "Generated scenes: NAME or NAME:key=value,key=value,...\n";
  for (const Generator& generator : kGenerators) {
    const std::string defaults = generator.defaults.empty() ? "" : fmt::format(" ({})", generator.defaults);
    text += fmt::format("  {:<10}{}{}\n", generator.name, generator.meaning, defaults);
  }
  text += "Their keys, with defaults (a fraction such as 1/3000 is a number, too):\n";
  const GeneratorParams defaults;
  for (const Parameter& parameter : kParameters) {
    text += fmt::format("  {:<20}{}\n", fmt::format("{}={}", parameter.key, value_text(defaults, parameter.field)),
                        parameter.meaning);
  }
  return text;
}

}  // namespace sweepgrid
