#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace sweepgrid {

/// Where work runs: serially on the calling thread, on oneTBB workers of its own arena, or in the host's arena.
/// Every use of threads goes through here. Implementations are thread-safe; one executor may serve many engines. Those
/// made here run everything in the standard FloatingPointMode, whatever the caller's is.
class Executor {
 public:
  virtual ~Executor() = default;

  /// Most workers that can run at once, the caller included; 1 when serial.
  [[nodiscard]] virtual int concurrency() const = 0;

  /// Number of the worker that calls, in [0, concurrency()); its own among those inside at the same time. To be called
  /// from within for_each() or execute().
  [[nodiscard]] virtual int worker() const = 0;

  /// Runs `body(i)` once for every i in [0, count), in any order on any workers, and returns when all have ended.
  /// An idle worker that steals starts with the lowest index of what it stole. The first exception is rethrown.
  virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& body) = 0;

  /// Runs `work` once, inside the executor's arena where there is one, and returns when it has ended. On the calling
  /// thread, or on a worker when more threads call than the arena has slots. Rethrows what `work` throws.
  virtual void execute(const std::function<void()>& work) = 0;
};

/// No thread, no oneTBB: the calling thread does all.
[[nodiscard]] std::shared_ptr<Executor> make_serial_executor();

/// `threads` workers, the caller included; 0 means as many as the machine has, 1 is the serial executor. More than the
/// machine has are really started (oversubscribed), unless the host limits oneTBB's parallelism itself. Throws
/// std::invalid_argument when negative or above 65536.
[[nodiscard]] std::shared_ptr<Executor> make_executor(int threads);

}  // namespace sweepgrid
