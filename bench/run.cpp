#include "run.hpp"

#include <malloc.h>

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "cli/step_times.hpp"
#include "measure/stopwatch.hpp"

namespace sweepgrid::bench {
namespace {

// The same for every system, and only the heap: what the process maps by itself is not seen.
std::uint64_t heap_in_use() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

struct StepTime {
  double whole = 0;
  double step_only = 0;
};

StepTime timed(System& system, const ScriptStep& changes) {
  const WallStopwatch whole;
  system.queue(changes);
  const WallStopwatch step_only;
  system.step();
  const double step_seconds = step_only.seconds();
  return {whole.seconds(), step_seconds};
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

double Run::ns_per_update() const { return changes == 0 ? 0 : 1e9 * sum(whole_steps) / static_cast<double>(changes); }

double Run::step_only_ns_per_update() const {
  return changes == 0 ? 0 : 1e9 * step_only / static_cast<double>(changes);
}

double Run::p99_over_mean() const {
  const StepTimes times{whole_steps};
  return whole_steps.empty() ? 0 : times.p99() / times.mean();
}

double Run::max_over_median() const {
  const StepTimes times{whole_steps};
  return whole_steps.empty() ? 0 : times.quantile(1) / times.median();
}

double Run::bytes_per_object() const { return live == 0 ? 0 : static_cast<double>(bytes.value_or(heap_bytes)) / live; }

double Run::heap_bytes_per_object() const { return live == 0 ? 0 : static_cast<double>(heap_bytes) / live; }

Run play(const SystemMaker& maker, const SceneScript& script, const SceneTruth& truth) {
  Run run;
  const std::uint64_t heap_before = heap_in_use();
  const auto system = maker(script.objects);
  const auto check = [&](std::size_t step) {
    if (!truth.knows(step)) return;
    const std::vector<ObjectPair> pairs = system->pairs();
    run.pairs = digest(pairs);
    if (std::string complaint = truth.complaint(step, pairs); !complaint.empty()) run.complaints.push_back(complaint);
  };
  for (std::size_t step = 0; step < script.steps.size(); ++step) {
    const StepTime time = timed(*system, script.steps[step]);
    if (step == 0) {
      run.first_insertion = time.whole;
    } else {
      run.whole_steps.push_back(time.whole);
      run.step_only += time.step_only;
      run.changes += script.steps[step].changes();
    }
    check(step);
  }
  run.heap_bytes = heap_in_use() - heap_before;
  run.bytes = system->counted_bytes();
  run.live = script.live;
  run.events = system->events();
  if (run.events && run.events->begins - run.events->ends != run.pairs.count) {
    run.complaints.push_back(fmt::format("{} begins and {} ends do not leave {} pairs", run.events->begins,
                                         run.events->ends, run.pairs.count));
  }
  const PairDigest pairs_at_end = run.pairs;
  run.removal = timed(*system, script.removal).whole;
  check(script.steps.size());
  run.pairs = pairs_at_end;
  return run;
}

}  // namespace sweepgrid::bench
