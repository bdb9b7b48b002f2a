#include "study/study_points.hpp"

#include <csignal>
#include <cstddef>

#include <fmt/format.h>

#include "measure/stopwatch.hpp"
#include "study/study_progress.hpp"

namespace sweepgrid::study {
namespace {

// All that a signal handler may touch.
volatile std::sig_atomic_t interrupted = 0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

/// While it lives, the first SIGINT or SIGTERM is noted; a second one acts as ever.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupted = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
  }
  ~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction old_int_ {};
  struct sigaction old_term_ {};
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
      throw Interrupted(
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
