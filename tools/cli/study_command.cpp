#include "cli/study_command.hpp"

#include <algorithm>

#include "cli/command_options.hpp"
#include "study/accuracy/accuracy_study.hpp"
#include "study/figures/figures_study.hpp"
#include "study/scaling/scaling_study.hpp"
#include "study/stability/stability_study.hpp"
#include "study/study_options.hpp"

namespace sweepgrid {
namespace {

constexpr int kMostSimulated = 4096;

// The options that all studies have.
void add_study_options(CLI::App& command, study::StudyOptions& options) {
  command.add_option("--out", options.out, "Folder to write into (default: the current one)")->type_name("DIR");
  command.add_flag("--quick", options.quick, "A rough answer within a minute");
  CLI::Option* resume = command.add_flag_callback(
      "--resume", [&options] { options.points = study::Points::kResume; },
      "Insist on the finished points of an earlier run; they are taken without this, too, where there are any");
  command
      .add_flag_callback(
          "--fresh", [&options] { options.points = study::Points::kFresh; }, "Measure all points anew")
      ->excludes(resume);
}

}  // namespace

StudyCommand::StudyCommand(CLI::App& app)
    : command_(app.add_subcommand("study", "Measure, and write a report as JSON and as one page of HTML")) {
  command_->require_subcommand(1);
  add_figures();
  add_scaling();
  add_stability();
  add_accuracy();
}

bool StudyCommand::run() const {
  const auto study = std::find_if(studies_.begin(), studies_.end(),
                                  [](const Study& candidate) { return candidate.command->parsed(); });
  return study->run();
}

void StudyCommand::add_figures() {
  CLI::App* command = command_->add_subcommand("figures", "The figures and claims of the paper, beside this machine");
  const auto options = std::make_shared<study::FiguresOptions>();
  add_study_options(*command, options->study);
  command->add_option("--figure", options->figures, "Only these figures of the paper: 2, 8, 9, 10, 11")
      ->type_name("N...")
      ->check(CLI::IsMember(study::figure_numbers()).description(""));
  studies_.push_back({command, [options] { return study::figures_study(*options); }});
}

void StudyCommand::add_scaling() {
  CLI::App* command = command_->add_subcommand("scaling", "How steps scale with threads: measured, and simulated");
  const auto options = std::make_shared<study::ScalingOptions>();
  add_study_options(*command, options->study);
  command->add_option("SCENE", options->scenes, "As of `sweepgrid run` (default: five generated ones)");
  add_numbers(
      *command, "--threads", NumberRange<int>{1, kMostThreads},
      [options](int count) { options->threads.push_back(count); },
      "Numbers of threads to measure (default: 1, 2, 4 ... all)");
  add_numbers(
      *command, "--simulate", NumberRange<int>{1, kMostSimulated},
      [options](int count) { options->simulate.push_back(count); },
      "Numbers of workers to predict (default: 1, 2, 4 ... 256)");
  command->add_flag("--weak", options->weak, "Also with objects that grow with the threads; generated scenes only");
  add_file(*command, "--trace", options->trace,
           "Write the tasks of a step to FILE, for Perfetto or chrome://tracing; - is stdout");
  studies_.push_back({command, [options] { return study::scaling_study(*options); }});
}

void StudyCommand::add_stability() {
  CLI::App* command = command_->add_subcommand("stability", "Where methods break: cost and exactness in hard scenes");
  const auto options = std::make_shared<study::StudyOptions>();
  add_study_options(*command, *options);
  studies_.push_back({command, [options] { return study::stability_study(*options); }});
}

void StudyCommand::add_accuracy() {
  CLI::App* command = command_->add_subcommand("accuracy", "Speed against accuracy: every setting beside the truths");
  const auto options = std::make_shared<study::AccuracyOptions>();
  add_study_options(*command, options->study);
  command->add_option("SCENE", options->scenes, "As of `sweepgrid run` (default: six generated ones)");
  add_number(
      *command, "--narrow-cost", NumberRange<double>(), [options](double ns) { options->narrow_cost = ns; },
      "Of a narrow phase per pair (default: measured)")
      ->type_name("NS");
  studies_.push_back({command, [options] { return study::accuracy_study(*options); }});
}

}  // namespace sweepgrid
