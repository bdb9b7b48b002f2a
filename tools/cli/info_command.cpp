#include "cli/info_command.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/scene_census.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

void print_line(std::string_view name, std::string_view value) { fmt::print("  {:<18} {}\n", name, value); }

std::string box_text(const std::optional<SceneBox>& box) {
  if (!box) return "none";
  return fmt::format("[{:.6g}] to [{:.6g}]", fmt::join(box->min, ", "), fmt::join(box->max, ", "));
}

template <class T>
std::string per_step(const Range<T>& range, std::uint64_t steps) {
  if (steps == 0) return "none";
  return fmt::format("{:.6g} in all, {:.6g} per step ({} to {})", range.sum, range.sum / static_cast<double>(steps),
                     range.least, range.most);
}

void print_info(const SceneInfo& info) {
  fmt::print("{}\n", info.name);
  print_line("format", info.compression == "none" ? info.format : info.format + ", " + info.compression);
  if (info.dim != 3) print_line("dimensions", fmt::format("{}", info.dim));
  for (const auto& [name, value] : info.details) print_line(name, value);
  print_line("bounds told", box_text(info.bounds));
}

void print_census(const SceneCensus& census) {
  print_line("bounds found", box_text(census.extent));
  print_line("steps", fmt::format("{} after the start", census.steps));
  print_line("objects", fmt::format("{} first, {} last, {} to {}", census.objects_first, census.objects_last,
                                    census.objects.least, census.objects.most));
  if (census.extent) print_line("widths", fmt::format("{:.6g} to {:.6g}", census.width.least, census.width.most));
  print_line("moved", per_step(census.moved, census.steps));
  if (census.moved.sum > 0) {
    print_line("  of all living", fmt::format("{:.2f} % per step ({:.2f} to {:.2f})",
                                              100 * census.moved_part.sum / static_cast<double>(census.steps),
                                              100 * census.moved_part.least, 100 * census.moved_part.most));
    print_line("  over 1 % width",
               fmt::format("{:.2f} % of the moves", 100 * static_cast<double>(census.far_moved) / census.moved.sum));
  }
  print_line("inserted", per_step(census.inserted, census.steps));
  print_line("erased", per_step(census.erased, census.steps));
  print_line("overlapping pairs", fmt::format("{} first, {} last", census.pairs_first, census.pairs_last));
}

}  // namespace

void info_command(const InfoOptions& options) {
  const bool rounded = options.scalar == ScalarKind::kFloat;
  SceneOptions scene_options = options.scene;
  if (rounded) scene_options.largest = std::numeric_limits<float>::max();
  std::vector<std::string> failures;
  for (const std::string& scene : options.scenes) {
    try {
      const std::unique_ptr<SceneSource> source = open_scene(scene, scene_options);
      print_info(source->info());
      const SceneCensus census = take_census(*source, options.steps, rounded);
      if (census.started) print_census(census);
      if (!census.error.empty()) failures.push_back(census.error);
    } catch (const SceneError& error) {
      failures.emplace_back(error.what());
    }
  }
  if (!failures.empty()) throw SceneError(fmt::format("{}", fmt::join(failures, "\nsweepgrid: ")));
}

}  // namespace sweepgrid
