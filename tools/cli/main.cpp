// The `sweepgrid` program. Exit status: 0 all is well, 1 a verification failed, an invariant is broken or no
// configuration meets a demand, 2 bad usage, file or scene, 130 a study was interrupted.

#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/build_info.hpp"
#include "cli/cell_names.hpp"
#include "cli/info_command.hpp"
#include "cli/run_command.hpp"
#include "cli/study_command.hpp"
#include "cli/tune_command.hpp"
#include "scenes/generator_params.hpp"
#include "setup/setup_json.hpp"
#include "study/study_options.hpp"

namespace sweepgrid {
namespace {

enum ExitStatus { kWell = 0, kNotVerified = 1, kBadInput = 2, kInterrupted = 130 };

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

// The checks of CLI11 take NaN for a number within any bounds.
CLI::Validator finite_number(bool zero_too, bool auto_too, const std::string& description) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        if (auto_too && text == "auto") return "";
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
        if (is_number && (value > 0 || (zero_too && value == 0))) return "";
        return fmt::format("'{}' is not a {} finite number{}", text, zero_too ? "non-negative" : "positive",
                           auto_too ? " or 'auto'" : "");
      },
      description);
}

CLI::Validator whole_number_or_auto() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        if (text == "auto") return "";
        int value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error == std::errc() && end == text.data() + text.size() && value > 0) return "";
        return fmt::format("'{}' is not a positive whole number or 'auto'", text);
      },
      "auto|N");
}

// Options that both commands have.
template <class Options>
void add_scene_options(CLI::App& command, Options& options) {
  command.add_option("SCENE", options.scenes, kScenesHelp)->required();
  command.add_option("--steps", options.steps, "Stop after so many steps, the start not counted")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--diameter", options.scene.diameter, "Of the atoms of a dump without a column for it")
      ->check(finite_number(true, false, ""));
  const std::map<std::string, ScalarKind> scalars = {{"float", ScalarKind::kFloat}, {"double", ScalarKind::kDouble}};
  command.add_option("--scalar", options.scalar, "Round boxes to float (default) or keep them in double")
      ->transform(CLI::CheckedTransformer(scalars).description("float|double"));
}

// What cannot be parsed into RunOptions at once.
struct RunTexts {
  std::string cell = "auto";
  std::string cell_size = "auto";
  std::string cell_population = "auto";
};

CLI::App* add_run(CLI::App& app, RunOptions& options, RunTexts& texts) {
  CLI::App* run = app.add_subcommand("run", "Run the engine over scenes and print one line for each");
  add_scene_options(*run, options);
  run->add_option("--threads", options.threads, "Workers; 0 (default): all cores, 1: none but the caller")
      ->check(CLI::NonNegativeNumber);
  CLI::Option* config =
      run->add_option("--config", options.config_path, "Take the setup from FILE, such as `sweepgrid tune` writes it")
          ->type_name("FILE");
  run->add_option("--cell", texts.cell, "Kind of the cells: auto|rows|segmented|batch|classic|plane (default: auto)")
      ->check(CLI::IsMember({"auto", "rows", "segmented", "batch", "classic", "plane"}).description(""));
  run->add_option("--cell-size", texts.cell_size,
                  "Edge of the finest grid's cells, in the scene's units (default: auto)")
      ->check(finite_number(false, true, "auto|X"));
  run->add_option("--cell-population", texts.cell_population,
                  "Objects per cell that a derived cell size aims at (default: auto)")
      ->check(whole_number_or_auto());
  run->add_option("--segment-capacity", options.segment_capacity, "Endpoints per segment, 4 to 65536 (segmented)")
      ->check(CLI::Range(4, 1 << 16).description(""));
  run->add_option("--reduction", options.reduction,
                  "How deltas become events: reporter (default; one cell reports each) or counts (of witnesses)")
      ->transform(CLI::CheckedTransformer(reductions_by_name()).description("reporter|counts"));
  // What the file tells is not to be told twice; but --threads wins over it.
  for (const char* told :
       {"--scalar", "--cell", "--cell-size", "--cell-population", "--segment-capacity", "--reduction"}) {
    config->excludes(run->get_option(told));
  }
  run->add_option("--events", options.events_path, kEventsHelp)->type_name("FILE");
  run->add_option("--json", options.json_path, "Write all results to FILE (see tools/README.md); - is stdout")
      ->type_name("FILE");
  run->add_flag("--verify", options.verify,
                "Compare the events of every step with an independent computation; exit status 1 if they differ");
  return run;
}

void complete(RunOptions& options, const RunTexts& texts) {
  if (texts.cell != "auto") options.cell = cell_kinds_by_name().at(texts.cell);
  if (texts.cell_size != "auto") options.cell_size = std::stod(texts.cell_size);
  if (texts.cell_population != "auto") options.cell_population = std::stoi(texts.cell_population);
  if (options.events_path == "-" && options.json_path == "-") {
    throw CLI::ValidationError("--events and --json cannot both be the standard output");
  }
}

// A misspelt name at the end of a long list should not cost the work on the others.
void check_scenes(const std::vector<std::string>& scenes) {
  for (const std::string& scene : scenes) {
    if (!parse_generator(scene) && !std::filesystem::exists(scene)) {
      throw std::runtime_error(scene + ": neither a file nor a generator (see sweepgrid --help)");
    }
  }
}

int run_main(int argc, char** argv) {
  CLI::App app("Exact, event-based broad-phase collision detection, run over scenes");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(
      generator_help() +
      "Exit status: 0 all is well, 1 a verification failed or a demand cannot be met, 2 bad usage, file or scene, "
      "130 a study was interrupted.");
  RunOptions run_options;
  RunTexts run_texts;
  const CLI::App* run = add_run(app, run_options, run_texts);
  InfoOptions info_options;
  CLI::App* info = app.add_subcommand("info", "Read scenes to their end and describe them");
  add_scene_options(*info, info_options);
  const TuneCommand tune(app);
  const StudyCommand study(app);
  try {
    app.parse(argc, argv);
    complete(run_options, run_texts);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kWell : kBadInput;
  }
  if (study.parsed()) return study.run() ? kWell : kNotVerified;
  if (tune.parsed()) return tune.run() ? kWell : kNotVerified;
  check_scenes(run->parsed() ? run_options.scenes : info_options.scenes);
  if (run->parsed()) {
    if (!run_options.config_path.empty()) run_options.setup = read_setup(run_options.config_path);
    return run_command(run_options) ? kWell : kNotVerified;
  }
  info_command(info_options);
  return kWell;
}

}  // namespace
}  // namespace sweepgrid

int main(int argc, char** argv) {
  try {
    return sweepgrid::run_main(argc, argv);
  } catch (const sweepgrid::study::Interrupted& interrupted) {
    fmt::print(stderr, "sweepgrid: {}\n", interrupted.what());
    return sweepgrid::kInterrupted;
  } catch (const std::exception& error) {
    const std::string_view message = error.what();
    fmt::print(stderr, "{}{}\n", message.starts_with("sweepgrid: ") ? "" : "sweepgrid: ", message);
    return sweepgrid::kBadInput;
  }
}
