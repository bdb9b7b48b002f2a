#include "cli/scene_run.hpp"

#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include <fmt/format.h>

#include <sweepgrid/sap/invariant.hpp>

#include "cli/machine_info.hpp"
#include "cli/progress_bar.hpp"
#include "scenes/scene_error.hpp"
#include "setup/guarantee.hpp"
#include "setup/scene_engine.hpp"

namespace sweepgrid {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kStepsPerPairsCheck = 10;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

/// One engine on its way through one scene.
class SceneRun {
 public:
  SceneRun(const SceneInfo& scene, const RunOptions& options, const std::shared_ptr<Executor>& executor,
           EventsFile* events)
      : scene_(scene), setup_(setup_of(options)), own_boxes_(!options.setup), events_file_(events) {
    setup_.config.executor = executor;
    engine_ = make_scene_engine(setup_, scene.dim);
    if (options.verify) verifier_.emplace();
  }

  SceneResult run(SceneSource& source, std::uint64_t step_limit) {
    result_.scene = scene_;
    ProgressBar progress(result_.scene.name, result_.scene.steps);
    SceneStep ops;
    result_.started = next(source, ops);
    bool right = !result_.started || try_step(ops);
    result_.objects_first = engine_->size();
    while (right && result_.started && result_.steps < step_limit && next(source, ops)) {
      ++result_.steps;
      right = try_step(ops);
      progress.show(result_.steps);
    }
    if (right && verifier_) verifier_->check_pairs(engine_->pairs());
    result_.objects_last = engine_->size();
    result_.stats = engine_->stats();
    result_.peak_bytes = peak_memory();
    if (verifier_) result_.verification = verifier_->result();
    if (!broken_.empty()) {
      if (!result_.verification) result_.verification.emplace();
      result_.verification->first_error = broken_;
    }
    return std::move(result_);
  }

 private:
  // False at the end, and where the scene cannot be read any further.
  bool next(SceneSource& source, SceneStep& ops) {
    try {
      return source.next(ops);
    } catch (const SceneError& error) {
      result_.error = error.what();
      return false;
    }
  }

  // False when the verifier found an error, or the engine found itself broken.
  bool try_step(SceneStep& ops) {
    try {
      return do_step(ops);
    } catch (const InvariantError& error) {
      broken_ = fmt::format("step {}: {}", result_.steps, error.what());
      return false;
    } catch (const std::length_error& error) {
      throw std::runtime_error(fmt::format("{}: step {}: {}", scene_.name, result_.steps, error.what()));
    }
  }

  bool do_step(SceneStep& ops) {
    prepare(ops);
    const Clock::time_point begin = Clock::now();
    const std::vector<Handle> inserted = engine_->queue(erased_, ops.inserted, updated_);
    const Clock::time_point queued = Clock::now();
    const Events<SceneKey>& events = engine_->step();
    const Clock::time_point end = Clock::now();
    for (std::size_t i = 0; i < inserted.size(); ++i) handles_[ops.inserted[i]] = inserted[i];
    count(ops, events, milliseconds(end - begin), milliseconds(end - queued));
    if (events_file_ != nullptr) events_file_->write(result_.steps, events);
    return verify(ops, events);
  }

  // What a client has at hand: its objects' handles, and its boxes in its own precision.
  void prepare(SceneStep& ops) {
    erased_.clear();
    updated_.clear();
    for (const SceneKey key : ops.erased) {
      const auto handle = handles_.find(key);
      erased_.push_back(handle->second);
      handles_.erase(handle);
    }
    for (const SceneKey key : ops.updated) updated_.push_back(handles_.find(key)->second);
    engine_->convert(ops.inserted_boxes, ops.updated_boxes);
    if (!verifier_ || !own_boxes_) return;
    engine_->as_taken(ops.inserted_boxes);
    engine_->as_taken(ops.updated_boxes);
  }

  void count(const SceneStep& ops, const Events<SceneKey>& events, double whole_ms, double step_ms) {
    pairs_ += events.begins.size();
    pairs_ -= events.ends.size();
    result_.pairs_last = pairs_;
    if (result_.steps == 0) {
      result_.start_ms = whole_ms;
      result_.pairs_first = pairs_;
      return;
    }
    result_.moved += ops.updated.size();
    result_.inserts += ops.inserted.size();
    result_.erases += ops.erased.size();
    result_.begins += events.begins.size();
    result_.ends += events.ends.size();
    result_.whole_times.samples.push_back(whole_ms);
    result_.step_times.samples.push_back(step_ms);
    const std::vector<StageTime> stages = engine_->stats().stages;
    result_.stage_totals.resize(stages.size());
    for (std::size_t i = 0; i < stages.size(); ++i) {
      result_.stage_totals[i].stage = stages[i].stage;
      result_.stage_totals[i].seconds += stages[i].seconds;
    }
  }

  bool verify(const SceneStep& ops, const Events<SceneKey>& events) {
    if (!verifier_) return true;
    if (!verifier_->check_step(ops, events, promised())) return false;
    if (result_.steps % kStepsPerPairsCheck != 0) return true;
    return verifier_->check_pairs(engine_->pairs());
  }

  // Of the engine's own boxes without a file, as every engine without envelopes does; else of the scene's.
  [[nodiscard]] Guarantee promised() const {
    if (own_boxes_) return Guarantee::kExact;
    const bool outside = engine_->envelope_report().violations > 0;
    return guarantee(setup_, scene_, accuracy::TruthKind::kInstants, outside);
  }

  SceneInfo scene_;
  EngineSetup setup_;
  bool own_boxes_;  // what is verified: the boxes as the engine has them
  std::unique_ptr<SceneEngine> engine_;
  EventsFile* events_file_;
  std::optional<Verifier> verifier_;
  std::unordered_map<SceneKey, Handle> handles_;
  std::vector<Handle> erased_;
  std::vector<Handle> updated_;
  std::size_t pairs_ = 0;
  std::string broken_;  // the invariant, if one is
  SceneResult result_;
};

}  // namespace

SceneResult run_scene(SceneSource& source, const RunOptions& options, const std::shared_ptr<Executor>& executor,
                      EventsFile* events) {
  reset_peak_memory();
  const std::uint64_t limit = options.steps.value_or(std::numeric_limits<std::uint64_t>::max());
  return SceneRun(source.info(), options, executor, events).run(source, limit);
}

}  // namespace sweepgrid
