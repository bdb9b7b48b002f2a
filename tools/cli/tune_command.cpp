#include "cli/tune_command.hpp"

#include <cstdint>
#include <cstdio>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "accuracy/narrow_phase.hpp"
#include "cli/command_options.hpp"
#include "cli/distinct_files.hpp"
#include "cli/output_file.hpp"
#include "cli/output_place.hpp"
#include "cli/provenance_json.hpp"
#include "cli/standard_streams.hpp"
#include "measure/stopwatch.hpp"
#include "tune/tune_json.hpp"

namespace sweepgrid {
namespace {

constexpr int kLastRounds = 7;  // of the best that an exhaustive search has found

double part_of(const char* option, const std::string& text) {
  try {
    return tune::parse_part(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", option, error.what()));
  }
}

tune::Tuning tune_scene(const tune::SceneText& scene, const tune::Demand& demand) {
  const ThreadStopwatch watch;
  tune::Tuning tuning;
  tuning.scene = scene;
  tuning.demand = demand;
  tuning.sample = tune::take_sample(scene, demand.truth);
  tuning.facts = tune::find_facts(tuning.sample);
  tuning.result =
      tune::tune(tuning.sample, tuning.facts, tuning.demand, tune::round_player(tuning.sample, tuning.demand));
  tuning.seconds = watch.seconds();
  return tuning;
}

}  // namespace

TuneCommand::TuneCommand(CLI::App& app)
    : command_(app.add_subcommand("tune", "Find the cheapest configuration for a scene, as JSON for run --config")) {
  using accuracy::TruthKind;
  const std::map<std::string, TruthKind> truths = {
      {"T0", TruthKind::kInstants}, {"T1", TruthKind::kMotion}, {"T2", TruthKind::kShapes}};
  command_->add_option("SCENE", scene_.name, "As of `sweepgrid run`")->required();
  add_number(
      *command_, "--steps", NumberRange<std::uint64_t>{.least = 1},
      [this](std::uint64_t count) { scene_.steps = count; }, "Only so many steps, the start not counted");
  add_diameter(*command_, scene_.options);
  add_choice(
      *command_, "--truth", truths, [this](TruthKind truth) { demand_.truth = truth; },
      "T0 (default): boxes overlap at the steps; T1: or between; T2: shapes");
  command_->add_option("--missed", missed_, "Part of the true pairs that may be missed; 0 (default): by guarantee")
      ->type_name("PART");
  command_->add_option("--extra", extra_, "Part of the reported pairs that may be none; 0: by guarantee (default: any)")
      ->type_name("PART");
  add_number(
      *command_, "--narrow-cost", NumberRange<double>(), [this](double ns) { narrow_ns_ = ns; },
      "Of a narrow phase per pair (default: measured)")
      ->type_name("NS");
  add_number(
      *command_, "--threads", NumberRange<int>{0, kMostThreads}, [this](int count) { demand_.threads = count; },
      "Workers; 0: all cores, 1 (default): none but the caller");
  add_file(*command_, "--json", json_path_, "Write the configuration to FILE (default: -, stdout)");
  command_->add_flag("--exhaustive", exhaustive_,
                     "Then measure every candidate over all steps, and tell how much better the best is");
}

bool TuneCommand::run() const {
  tune::Demand demand = demand_;
  demand.missed = part_of("--missed", missed_);
  if (!extra_.empty()) demand.extra = part_of("--extra", extra_);
  check_distinct({{"--json", json_path_}}, files_among({scene_.name}));
  OutputFile json(json_path_);
  if (narrow_ns_) {
    demand.narrow_ns = *narrow_ns_;
    demand.narrow_source = "as given";
  } else {
    const accuracy::NarrowPhasePrice price = accuracy::default_narrow_phase_price();
    demand.narrow_ns = price.ns;
    demand.narrow_source = price.source;
  }
  tune::Tuning tuning;
  try {
    tuning = tune_scene(scene_, demand);
  } catch (const tune::DemandNotMet& error) {
    show_on_stderr(fmt::format("sweepgrid: {}: {}\n", scene_.name, error.what()));
    return false;
  }
  if (exhaustive_) {
    const ThreadStopwatch reading;
    const tune::SceneSample whole = tune::take_whole(scene_, demand.truth);
    const double reading_seconds = reading.seconds();
    tuning.exhaustive = tune::search_exhaustively(whole, tuning.demand, tuning.result.chosen,
                                                  tune::round_player(whole, tuning.demand), kLastRounds);
    tuning.exhaustive->seconds += reading_seconds;
  }
  nlohmann::ordered_json document = tune_json(tuning);
  document["tune"]["build"] = build_json();
  document["tune"]["machine"] = machine_json();
  json.write(document.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  json.commit();
  std::FILE* const for_people = is_standard_output(json_path_) ? stderr : stdout;
  fmt::print(for_people, "{}", tune_text(tuning));
  flush_standard_stream(for_people);
  return true;
}

}  // namespace sweepgrid
