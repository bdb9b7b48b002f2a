// The `sweepgrid` program. Exit status: 0 all is well, 1 a verification failed, an invariant is broken or no
// configuration meets a demand, 2 bad usage, file or scene, 130 or 143 a study was interrupted.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/build_info.hpp"
#include "cli/cell_names.hpp"
#include "cli/command_options.hpp"
#include "cli/distinct_files.hpp"
#include "cli/info_command.hpp"
#include "cli/run_command.hpp"
#include "cli/standard_streams.hpp"
#include "cli/study_command.hpp"
#include "cli/tune_command.hpp"
#include "scenes/generator_params.hpp"
#include "setup/setup_json.hpp"
#include "study/study_options.hpp"

namespace sweepgrid {
namespace {

enum ExitStatus { kWell = 0, kNotVerified = 1, kBadInput = 2 };

constexpr const char* kScenesHelp =
    "Recordings (.aabbs, LAMMPS text dumps; bare or .gz, .xz, .zst) or generated scenes such as uniform:n=1000";
constexpr const char* kEventsHelp =
    "Write all events to FILE: a header line, then step,begin|end,a,b for each, step 0 being the start; with several "
    "scenes there is a first column, the scene's number from 1. FILE appears when it is complete; - is stdout";

std::string version_text() {
  const BuildInfo build = build_info();
  const std::string commit = build.commit.empty() ? "" : fmt::format(" ({})", build.commit);
  return fmt::format("sweepgrid {}{}", build.version, commit);
}

// Options that both commands have.
template <class Options>
void add_scene_options(CLI::App& command, Options& options) {
  command.add_option("SCENE", options.scenes, kScenesHelp)->required();
  add_number(
      command, "--steps", NumberRange<std::uint64_t>(), [&options](std::uint64_t count) { options.steps = count; },
      "Stop after so many steps, the start not counted");
  add_diameter(command, options.scene);
  const std::map<std::string, ScalarKind> scalars = {{"float", ScalarKind::kFloat}, {"double", ScalarKind::kDouble}};
  add_choice(
      command, "--scalar", scalars, [&options](ScalarKind scalar) { options.scalar = scalar; },
      "Round boxes to float (default) or keep them in double");
}

// What --config tells, too.
void add_setup_options(CLI::App& run, RunOptions& options) {
  add_choice(
      run, "--cell", cell_kinds_by_name(), [&options](CellKind kind) { options.cell = kind; },
      "Kind of the cells (default: auto)");
  add_number(
      run, "--cell-size", NumberRange<double>{.without_least = true, .auto_too = true},
      [&options](double size) { options.cell_size = size; },
      "Edge of the finest grid's cells, in the scene's units (default: auto)");
  add_number(
      run, "--cell-population", NumberRange<int>{.least = 1, .auto_too = true},
      [&options](int count) { options.cell_population = count; },
      "Objects per cell that a derived cell size aims at (default: auto)");
  add_number(
      run, "--segment-capacity", NumberRange<int>{4, CellOptions::kMostSegmentCapacity},
      [&options](int capacity) { options.segment_capacity = capacity; }, "Endpoints per segment (segmented)");
  add_choice(
      run, "--reduction", reductions_by_name(), [&options](Reduction reduction) { options.reduction = reduction; },
      "How deltas become events: reporter (default; one cell reports each) or counts (of witnesses)");
  add_choice(
      run, "--step-method", step_methods_by_name(), [&options](StepMethod method) { options.step_method = method; },
      "How steps find what changed: auto (default; what costs less), cells or sweep (of all objects)");
}

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Run the engine over scenes and print one line for each");
  add_scene_options(*run, options);
  add_number(
      *run, "--threads", NumberRange<int>{0, kMostThreads}, [&options](int count) { options.threads = count; },
      "Workers; 0 (default): all cores, 1: none but the caller");
  add_setup_options(*run, options);
  CLI::Option* config =
      add_file(*run, "--config", options.config_path, "Take the setup from FILE, such as `sweepgrid tune` writes it");
  // What the file tells is not to be told twice; but --threads wins over it.
  for (const char* told : {"--scalar", "--cell", "--cell-size", "--cell-population", "--segment-capacity",
                           "--reduction", "--step-method"}) {
    config->excludes(run->get_option(told));
  }
  add_file(*run, "--events", options.events_path, kEventsHelp);
  add_file(*run, "--json", options.json_path, "Write all results to FILE (see tools/README.md); - is stdout");
  run->add_flag("--verify", options.verify,
                "Compare the events of every step with an independent computation; exit status 1 if they differ");
  return run;
}

// A misspelt name at the end of a long list should not cost the work on the others.
void check_scenes(const std::vector<std::string>& scenes) {
  for (const std::string& scene : scenes) {
    if (!parse_generator(scene) && !std::filesystem::exists(scene)) {
      throw std::runtime_error(scene + ": neither a file nor a generator (see sweepgrid --help)");
    }
  }
}

void check_files(const RunOptions& options) {
  std::vector<NamedFile> inputs = files_among(options.scenes);
  inputs.push_back({"--config", options.config_path});
  check_distinct({{"--events", options.events_path}, {"--json", options.json_path}}, inputs);
}

int run_main(int argc, char** argv) {
  CLI::App app("Exact, event-based broad-phase collision detection, run over scenes");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(
      generator_help() +
      "Exit status: 0 all is well, 1 a verification failed or a demand cannot be met, 2 bad usage, file or scene, "
      "130 or 143 a study was interrupted (SIGINT, SIGTERM).");
  RunOptions run_options;
  const CLI::App* run = add_run(app, run_options);
  InfoOptions info_options;
  CLI::App* info = app.add_subcommand("info", "Read scenes to their end and describe them");
  add_scene_options(*info, info_options);
  const TuneCommand tune(app);
  const StudyCommand study(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream err;
    const int status = app.exit(error, out, err);
    show_on_stderr(err.str());
    write_standard_stream(stdout, out.str());
    return status == 0 ? kWell : kBadInput;
  }
  if (study.parsed()) return study.run() ? kWell : kNotVerified;
  if (tune.parsed()) return tune.run() ? kWell : kNotVerified;
  check_scenes(run->parsed() ? run_options.scenes : info_options.scenes);
  if (run->parsed()) {
    check_files(run_options);
    if (!run_options.config_path.empty()) run_options.setup = read_setup(run_options.config_path);
    return run_command(run_options) ? kWell : kNotVerified;
  }
  info_command(info_options);
  return kWell;
}

void complain(std::string_view message) {
  show_on_stderr(fmt::format("{}{}\n", message.starts_with("sweepgrid: ") ? "" : "sweepgrid: ", message));
}

}  // namespace
}  // namespace sweepgrid

int main(int argc, char** argv) {
  try {
    sweepgrid::hold_standard_streams();
    const int status = sweepgrid::run_main(argc, argv);
    sweepgrid::flush_standard_stream(stdout);
    return status;
  } catch (const sweepgrid::study::Interrupted& interrupted) {
    sweepgrid::complain(interrupted.what());
    return interrupted.exit_status();
  } catch (const std::bad_alloc&) {
    sweepgrid::complain("there is not enough memory for this");
  } catch (const std::exception& error) {
    sweepgrid::complain(error.what());
  }
  return sweepgrid::kBadInput;
}
