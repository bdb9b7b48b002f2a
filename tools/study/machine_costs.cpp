#include "study/machine_costs.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

#include "measure/stopwatch.hpp"
#include "setup/json_text.hpp"

namespace sweepgrid::study {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

// Where other programs run, most samples tell of them. What disturbs only adds, so the lower ones count.
Spread low_ones(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  return {samples[samples.size() / 5], samples.front(), samples[samples.size() / 2]};
}

void wait_for(double pause) {
  const Clock::time_point start = Clock::now();
  while (seconds(Clock::now() - start) < pause) {
  }
}

/// Lets two tasks run at once: each waits until the other has begun, or for so long that the other's thread must have
/// been set aside by the system.
class Meeting {
 public:
  void reset() {
    inside_ = 0;
    missed_ = false;
  }
  void join() {
    inside_.fetch_add(1, std::memory_order_acq_rel);
    const Clock::time_point start = Clock::now();
    while (inside_.load(std::memory_order_acquire) < 2) {
      if (seconds(Clock::now() - start) < kPatience) continue;
      missed_ = true;
      return;
    }
  }
  [[nodiscard]] bool happened() const { return !missed_; }

 private:
  static constexpr double kPatience = 5e-4;
  std::atomic<int> inside_ = 0;
  std::atomic<bool> missed_ = false;
};

/// Whether there is time left to look for more samples.
class Patience {
 public:
  explicit Patience(double seconds) : seconds_(seconds) {}
  [[nodiscard]] bool left() const { return watch_.seconds() < seconds_; }

 private:
  double seconds_;
  WallStopwatch watch_;
};

Spread measure_spawn(Executor& executor) {
  constexpr std::size_t kTasks = 4096;
  std::vector<double> samples;
  executor.execute([&] {
    for (int i = 0; i < 200; ++i) {
      const Clock::time_point start = Clock::now();
      executor.for_each(kTasks, [](std::size_t) {});
      samples.push_back(seconds(Clock::now() - start) * executor.concurrency() / kTasks);
    }
  });
  // The least: when only one worker takes part, it is charged for all.
  Spread figure = low_ones(std::move(samples));
  figure.median = figure.low;
  return figure;
}

// From the start of a loop to the second worker's first task, `pause` seconds after a loop in which it took part.
Spread measure_start(Executor& executor, double pause) {
  constexpr std::size_t kSamples = 100;
  std::vector<double> samples;
  executor.execute([&] {
    Meeting meeting;
    Clock::time_point started[2];
    const Patience patience(0.15);
    while (samples.size() < kSamples && patience.left()) {
      meeting.reset();
      executor.for_each(2, [&](std::size_t) { meeting.join(); });
      if (!meeting.happened()) continue;
      wait_for(pause);
      meeting.reset();
      const Clock::time_point start = Clock::now();
      executor.for_each(2, [&](std::size_t task) {
        started[task] = Clock::now();
        meeting.join();
      });
      const double latest = seconds(std::max(started[0], started[1]) - start);
      if (meeting.happened()) samples.push_back(latest);
    }
  });
  return low_ones(std::move(samples));
}

Spread measure_barrier(const std::shared_ptr<Executor>& executor) {
  StageGraph graph(executor);
  Meeting meeting;
  Clock::time_point ended[2];
  Clock::time_point planned;
  const auto first = graph.add(
      "first", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(2, 1); },
      [&](std::size_t task) {
        meeting.join();
        ended[task] = Clock::now();
      });
  graph.add(
      "second", {first}, [&](std::vector<std::uint64_t>&) { planned = Clock::now(); }, [](std::size_t) {});
  std::vector<double> samples;
  const Patience patience(0.2);
  while (samples.size() < 200 && patience.left()) {
    meeting.reset();
    graph.run();
    if (meeting.happened()) samples.push_back(seconds(planned - std::max(ended[0], ended[1])));
  }
  return low_ones(std::move(samples));
}

// The pause from which on workers sleep, and what waking takes. Pauses of which no sample came through are left out.
void measure_wake(Executor& executor, MachineCosts& costs) {
  constexpr double kPauses[] = {0, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3};
  std::vector<std::pair<double, Spread>> starts;
  for (const double pause : kPauses) {
    const Spread start = measure_start(executor, pause);
    if (start.median > 0) starts.emplace_back(pause, start);
  }
  if (starts.size() < 3) return;
  costs.steal = starts.front().second;
  const double steal = costs.steal.median;
  const Spread& last = starts.back().second;
  costs.wake = {std::max(0.0, last.median - steal), std::max(0.0, last.low - steal), std::max(0.0, last.high - steal)};
  std::size_t asleep = starts.size() - 1;
  while (asleep > 1 && starts[asleep - 1].second.median > (steal + last.median) / 2) --asleep;
  costs.spin = {(starts[asleep - 1].first + starts[asleep].first) / 2, starts[asleep - 1].first, starts[asleep].first};
}

/// A short piece of work of one worker, by wall and by processor time.
struct Piece {
  Clock::time_point begin;
  Clock::time_point end;
  double processor_seconds = 0;

  // Not set aside by the system meanwhile.
  [[nodiscard]] bool whole() const { return processor_seconds > 0.95 * seconds(end - begin); }
};

/// How fast one worker does a piece of work, and how many times as fast all do it together. Pieces are short, so that
/// there are some during which nobody was set aside; others do not count.
class TogetherBench {
 public:
  using Body = std::function<void(std::size_t worker, std::size_t piece)>;
  TogetherBench(Executor& executor, Body body) : executor_(executor), body_(std::move(body)) {}

  // Pieces per second of one worker, and the speed of all over that of one.
  std::pair<Spread, Spread> run(double patience_seconds) {
    const auto workers = static_cast<std::size_t>(executor_.concurrency());
    std::vector<double> alone;
    std::vector<double> together;
    const Patience patience(patience_seconds);
    while (together.size() < 100 && patience.left()) {
      if (const auto time = time_of(1)) alone.push_back(*time);
      if (const auto time = time_of(workers)) together.push_back(*time);
    }
    if (alone.empty() || together.empty()) return {};
    const Spread one = spread(alone);
    const Spread all = spread(together);
    const auto count = static_cast<double>(workers);
    return {{1 / one.median, 1 / one.high, 1 / one.low},
            {count * one.median / all.median, count * one.low / all.high, count * one.high / all.low}};
  }

 private:
  // Mean time of a piece; absent when a worker was set aside, or they did not run together.
  std::optional<double> time_of(std::size_t workers) {
    std::vector<Piece> pieces(workers);
    std::atomic<std::size_t> missing = workers;
    ++round_;
    executor_.for_each(workers, [&](std::size_t worker) {
      --missing;
      const Patience patience(5e-4);
      while (missing > 0 && patience.left()) {
      }
      Piece& piece = pieces[worker];
      piece.begin = Clock::now();
      const ThreadStopwatch processor;
      body_(worker, round_);
      piece.processor_seconds = processor.seconds();
      piece.end = Clock::now();
    });
    Clock::time_point begin = pieces[0].begin;
    Clock::time_point end = pieces[0].end;
    double sum = 0;
    for (const Piece& piece : pieces) {
      if (!piece.whole()) return std::nullopt;
      begin = std::min(begin, piece.begin);
      end = std::max(end, piece.end);
      sum += seconds(piece.end - piece.begin);
    }
    const double mean = sum / static_cast<double>(workers);
    if (seconds(end - begin) > 1.2 * mean) return std::nullopt;
    return mean;
  }

  Executor& executor_;
  Body body_;
  std::size_t round_ = 0;
};

void measure_memory(Executor& executor, MachineCosts& costs) {
  // A piece is a slice of more than the caches hold, and the next one another slice.
  constexpr std::size_t kSlice = std::size_t{4} << 20;
  constexpr std::size_t kSlices = 16;
  const auto workers = static_cast<std::size_t>(executor.concurrency());
  std::vector<std::vector<char>> from(workers, std::vector<char>(kSlice * kSlices, 1));
  std::vector<std::vector<char>> to = from;
  TogetherBench bench(executor, [&](std::size_t worker, std::size_t piece) {
    const std::size_t at = kSlice * (piece % kSlices);
    std::memcpy(&to[worker][at], &from[worker][at], kSlice);
  });
  std::tie(costs.stream, costs.roof) = bench.run(0.6);
  for (double* const figure : {&costs.stream.median, &costs.stream.low, &costs.stream.high}) *figure *= 2.0 * kSlice;
}

void measure_cores(Executor& executor, MachineCosts& costs) {
  std::vector<std::uint64_t> sums(static_cast<std::size_t>(executor.concurrency()) * 8);
  TogetherBench bench(executor, [&](std::size_t worker, std::size_t piece) {
    std::uint64_t x = piece;
    for (int i = 0; i < 300'000; ++i) x = x * 6364136223846793005 + 1442695040888963407;
    sums[8 * worker] += x;
  });
  costs.cores = bench.run(0.4).second;
}

}  // namespace

MachineCosts measure_machine_costs() {
  MachineCosts costs;
  // Where other programs run, the system may leave two workers on one core for long. New threads may have more luck.
  for (int attempt = 0; attempt < 4; ++attempt) {
    const std::shared_ptr<Executor> executor = make_executor(0);
    costs.threads = executor->concurrency();
    if (costs.threads > 1 && costs.steal.median <= 0) measure_wake(*executor, costs);
    if (costs.threads > 1 && costs.barrier.median <= 0) costs.barrier = measure_barrier(executor);
    if (costs.spawn.median <= 0) costs.spawn = measure_spawn(*executor);
    if (costs.roof.median <= 0) measure_memory(*executor, costs);
    if (costs.cores.median <= 0) measure_cores(*executor, costs);
  }
  return costs;
}

ScheduleCosts MachineCosts::schedule_costs(bool memory) const {
  ScheduleCosts result;
  result.spawn = spawn.median;
  result.steal = steal.median;
  result.wake = wake.median;
  result.spin = spin.median;
  result.barrier = barrier.median;
  if (memory && roof.median > 0) result.memory_roof = std::max(1.0, roof.median);
  return result;
}

namespace {

// Every figure by its name, for both directions.
template <class Costs, class Visit>
void for_each_figure(Costs& costs, Visit&& visit) {
  visit("spawn_s", costs.spawn);
  visit("steal_s", costs.steal);
  visit("wake_s", costs.wake);
  visit("spin_s", costs.spin);
  visit("barrier_s", costs.barrier);
  visit("stream_bytes_per_s", costs.stream);
  visit("memory_roof", costs.roof);
  visit("cores", costs.cores);
}

}  // namespace

void to_json(nlohmann::json& json, const MachineCosts& costs) {
  json = {{"threads", costs.threads}};
  for_each_figure(costs, [&](const char* name, const Spread& figure) {
    json[name] = {{"median", figure.median}, {"low", figure.low}, {"high", figure.high}};
  });
}

void from_json(const nlohmann::json& json, MachineCosts& costs) {
  get_member(json, "threads", costs.threads);
  for_each_figure(costs, [&](const char* name, Spread& figure) {
    const auto found = member_of<nlohmann::json>(json, name);
    figure = {member_of<double>(found, "median"), member_of<double>(found, "low"), member_of<double>(found, "high")};
  });
}

}  // namespace sweepgrid::study
