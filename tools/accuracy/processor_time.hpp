#pragma once

#include <ctime>

namespace sweepgrid::accuracy {

/// Processor time of the calling thread from when it is made: what other programs take of the core is not in it.
class ProcessorTime {
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

}  // namespace sweepgrid::accuracy
