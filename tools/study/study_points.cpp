#include "study/study_points.hpp"

#include <csignal>
#include <cstddef>

#include <fmt/format.h>

#include "measure/stopwatch.hpp"
#include "study/study_progress.hpp"

namespace sweepgrid::study {
namespace {

// What the signal handler uses; sigaction() is among what it may call.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
volatile std::sig_atomic_t interrupted = 0;  // by which signal
struct sigaction old_int {};
struct sigaction old_term {};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void restore_signals() {
  sigaction(SIGINT, &old_int, nullptr);
  sigaction(SIGTERM, &old_term, nullptr);
}

/// While it lives, the first SIGINT or SIGTERM is noted; a second one acts as it did before. One at a time.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupted = 0;
    sigaction(SIGINT, nullptr, &old_int);
    sigaction(SIGTERM, nullptr, &old_term);
    struct sigaction action {};
    action.sa_handler = [](int signal) {
      interrupted = signal;
      restore_signals();
    };
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
  }
  ~InterruptGuard() { restore_signals(); }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace

void measure_points(const std::string& title, const std::vector<StudyPoint>& points, PointStore& store) {
  const InterruptGuard guard;
  double cost = 0;
  for (const StudyPoint& point : points) cost += point.cost;
  StudyProgress progress(title, points.size(), cost);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StudyPoint& point = points[i];
    if (store.find(point.key) != nullptr) {
      progress.skip(point.cost);
      continue;
    }
    if (interrupted != 0) {
      throw Interrupted(interrupted,
                        fmt::format("interrupted; finished points are kept in {}, and the same command goes on with "
                                    "those that are missing",
                                    store.path().string()));
    }
    progress.begin(point.key);
    const WallStopwatch watch;
    store.add(point.key, point.measure());
    progress.end(point.cost, watch.seconds());
  }
}

}  // namespace sweepgrid::study
