#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace sweepgrid::accuracy {

/// What a run may use.
struct RunBudget {
  std::uint64_t bytes = std::uint64_t{1} << 30;  ///< of address space, beyond what the process has when it starts
  double seconds = 60;                           ///< of processor time; ten times as long on the clock
};

enum class RunEnd {
  kDone,         ///< `text` is what the work returned
  kOutOfMemory,  ///< the budget did not suffice: std::bad_alloc
  kOutOfTime,    ///< killed at the end of its time
  kError,        ///< `text` is what() of the exception that left the work
  kCrash,        ///< `text` names the signal, or tells the exit status
};

struct GuardedRun {
  RunEnd end = RunEnd::kDone;
  std::string text;
  double seconds = 0;            ///< wall time of the whole run
  std::uint64_t peak_bytes = 0;  ///< the most resident memory of the process that ran it
};

/// Runs `work` in a process of its own, so that nothing it does can harm this one: neither memory nor time without end,
/// nor a crash. What it changes is lost but for the text it returns.
///
/// The process is a copy of this one with the calling thread alone: `work` must not use threads that this process has
/// started, nor wait for them. An engine on one thread is fine, one on several is not once this process has run any on
/// several. Throws std::system_error when no process or pipe is to be had.
[[nodiscard]] GuardedRun run_guarded(const RunBudget& budget, const std::function<std::string()>& work);

}  // namespace sweepgrid::accuracy
