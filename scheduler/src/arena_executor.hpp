#pragma once

#include <optional>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// An executor on a oneTBB arena, its own or the host's. StageGraph recognises it to run its stages as a flow graph.
class ArenaExecutor final : public Executor {
 public:
  /// An arena of its own with `threads` slots, one of them for the caller. Precondition: threads >= 1.
  explicit ArenaExecutor(int threads);
  explicit ArenaExecutor(oneapi::tbb::task_arena& host);

  [[nodiscard]] int concurrency() const override;
  [[nodiscard]] int worker() const override;
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
  void execute(const std::function<void()>& work) override;

 private:
  std::optional<oneapi::tbb::global_control> oversubscription_;
  std::optional<oneapi::tbb::task_arena> own_;
  oneapi::tbb::task_arena& arena_;
};

}  // namespace sweepgrid
