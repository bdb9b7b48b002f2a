#include "arena_executor.hpp"

#include <algorithm>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_group.h>

#include <sweepgrid/scheduler/floating_point_mode.hpp>
#include <sweepgrid/scheduler/host_arena.hpp>

namespace sweepgrid {
namespace {

// oneTBB allows the smallest of all the limits in force. Executors that oversubscribe all ask for the same generous
// one, so that two of different sizes do not hold each other back; the slots of the arena are what bounds each.
constexpr int kOversubscribedLimit = 256;

}  // namespace

ArenaExecutor::ArenaExecutor(int threads) : own_(std::in_place, threads), arena_(*own_) {
  if (threads > oneapi::tbb::info::default_concurrency()) {
    oversubscription_.emplace(oneapi::tbb::global_control::max_allowed_parallelism,
                              static_cast<std::size_t>(std::max(threads, kOversubscribedLimit)));
  }
  arena_.initialize();
}

ArenaExecutor::ArenaExecutor(oneapi::tbb::task_arena& host) : arena_(host) { arena_.initialize(); }

int ArenaExecutor::concurrency() const { return arena_.max_concurrency(); }

int ArenaExecutor::worker() const { return std::max(0, oneapi::tbb::this_task_arena::current_thread_index()); }

void ArenaExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  arena_.execute([&] {
    if (count == 1) {
      const FloatingPointMode mode;
      return body(0);
    }
    // Isolated from the host twice over. What it cancels does not cut this short; and the thread that waits here for
    // the last body takes up no task of the host's or of another engine's, which would hold up this one.
    oneapi::tbb::task_group_context context(oneapi::tbb::task_group_context::isolated);
    oneapi::tbb::this_task_arena::isolate([&] {
      oneapi::tbb::parallel_for(
          oneapi::tbb::blocked_range<std::size_t>(0, count),
          [&body](const oneapi::tbb::blocked_range<std::size_t>& range) {
            const FloatingPointMode mode;
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
          },
          oneapi::tbb::simple_partitioner(), context);
    });
  });
}

void ArenaExecutor::execute(const std::function<void()>& work) {
  arena_.execute([&work] {
    const FloatingPointMode mode;
    work();
  });
}

std::shared_ptr<Executor> make_executor_in(oneapi::tbb::task_arena& arena) {
  return std::make_shared<ArenaExecutor>(arena);
}

}  // namespace sweepgrid
