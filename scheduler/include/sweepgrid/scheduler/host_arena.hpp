#pragma once

#include <memory>

#include <oneapi/tbb/task_arena.h>

#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// Runs in the host's arena, with the host's workers and priorities. `arena` must outlive the executor.
/// A thread that waits for a stage graph in it may run other tasks of the arena meanwhile, as everywhere in oneTBB:
/// call step() with no lock held that those tasks take. What the host cancels around a call does not cut the call
/// short. The only public header that includes oneTBB; clients that do not use it do not need oneTBB's headers.
[[nodiscard]] std::shared_ptr<Executor> make_executor_in(oneapi::tbb::task_arena& arena);

}  // namespace sweepgrid
