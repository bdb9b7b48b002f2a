#include "cli/run_table.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "cli/standard_streams.hpp"
#include "scenes/generator_params.hpp"

namespace sweepgrid {
namespace {

constexpr double kMegabyte = 1e6;
constexpr std::size_t kWidestName = 44;

// What is told of every recording does not help to tell them apart.
std::string without_extensions(std::string name) {
  for (const std::string_view extension : {".xz", ".gz", ".zst", ".aabbs", ".lammpstrj"}) {
    if (name.ends_with(extension)) name.resize(name.size() - extension.size());
  }
  return name;
}

std::string cut_name(const std::string& scene) {
  std::string name = short_name(scene);
  if (name.size() <= kWidestName) return name;
  return name.substr(0, kWidestName - 3) + "...";
}

}  // namespace

std::string short_name(const std::string& scene) {
  if (parse_generator(scene)) return scene;
  const std::size_t slash = scene.find_last_of('/');
  return without_extensions(slash == std::string::npos ? scene : scene.substr(slash + 1));
}

RunTable::RunTable(std::FILE* out, const std::vector<std::string>& scenes) : out_(out) {
  for (const std::string& scene : scenes) name_width_ = std::max(name_width_, cut_name(scene).size());
}

void RunTable::print_head() const {
  fmt::print(out_, "{:<{}} {:>57} | {:>15} | {:>15} | {:>7} | {:>15}\n", "", name_width_, "", "ms per step",
             "ms step() alone", "ms", "MB");
  fmt::print(out_,
             "{:<{}} {:>7} {:>6} {:>9} {:>7} {:>7} {:>8} {:>7} | {:>7} {:>7} | {:>7} {:>7} | {:>7} | {:>7} {:>7}\n",
             "scene", name_width_, "objects", "steps", "moved", "inserts", "erases", "begins", "ends", "median", "p99",
             "median", "p99", "start", "engine", "peak");
  flush_standard_stream(out_);
}

void RunTable::print_row(const SceneResult& result) const {
  const auto megabytes = [](auto bytes) { return static_cast<double>(bytes) / kMegabyte; };
  fmt::print(out_,
             "{:<{}} {:>7} {:>6} {:>9} {:>7} {:>7} {:>8} {:>7} | {:>7.3f} {:>7.3f} | {:>7.3f} {:>7.3f} | {:>7.1f} | "
             "{:>7.2f} {:>7.1f}\n",
             cut_name(result.scene.name), name_width_, result.objects_last, result.steps, result.moved, result.inserts,
             result.erases, result.begins, result.ends, result.whole_times.median(), result.whole_times.p99(),
             result.step_times.median(), result.step_times.p99(), result.start_ms, megabytes(result.stats.bytes()),
             megabytes(result.peak_bytes));
  if (result.verification) fmt::print(out_, "  {}\n", verification_text(*result.verification));
  flush_standard_stream(out_);
}

std::string verification_text(const Verification& found) {
  const std::string counts =
      fmt::format("{} steps, {} pairs, {} missing, {} extra, {} duplicate, {} spurious", found.steps, found.pairs,
                  found.missing, found.extra, found.duplicate, found.spurious);
  const bool exact = found.promised == Guarantee::kExact;
  if (found.ok()) return "verified: " + counts + (exact ? "" : " (" + guarantee_name(found.promised) + ")");
  return fmt::format("NOT verified: {}, {} misordered\n  {}", counts, found.misordered, found.first_error);
}

}  // namespace sweepgrid
