#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <functional>
#include <span>
#include <vector>

namespace sweepgrid::study {

/// Wall time from when it is made.
class WallStopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Processor time of the calling thread from when it is made: for work of one thread, free of what other programs take
/// of the core.
class ThreadStopwatch {
 public:
  [[nodiscard]] double seconds() const { return now() - start_; }

 private:
  [[nodiscard]] static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double start_ = now();
};

/// Several samples of one figure.
struct Spread {
  double median = 0;
  double low = 0;
  double high = 0;
};

/// All 0 for no samples. The median of an even number is the mean of the middle two.
[[nodiscard]] inline Spread spread(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const std::size_t half = samples.size() / 2;
  const double median = samples.size() % 2 == 1 ? samples[half] : (samples[half - 1] + samples[half]) / 2;
  return {median, samples.front(), samples.back()};
}

/// Samples of several contenders in turn, round after round, so that what slows the machine for a while hits all of
/// them. `contenders[i]` returns one sample; the result holds its `rounds` samples at [i].
[[nodiscard]] inline std::vector<std::vector<double>> measure_in_turn(
    int rounds, std::span<const std::function<double()>> contenders) {
  std::vector<std::vector<double>> samples(contenders.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) samples[i].push_back(contenders[i]());
  }
  return samples;
}

/// first[i] / second[i] for samples of the same rounds: what slows a round cancels out.
[[nodiscard]] inline std::vector<double> ratios(std::span<const double> first, std::span<const double> second) {
  std::vector<double> result;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) result.push_back(first[i] / second[i]);
  return result;
}

}  // namespace sweepgrid::study
