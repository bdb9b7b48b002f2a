#include "accuracy/guarded_run.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>

namespace sweepgrid::accuracy {
namespace {

using Clock = std::chrono::steady_clock;

// The first byte that the child sends says how its work ended; the text follows.
constexpr char kDoneByte = 'd';
constexpr char kMemoryByte = 'm';
constexpr char kErrorByte = 'e';

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::uint64_t address_space() {
  std::uint64_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    unsigned long size = 0;
    if (std::fscanf(file, "%lu", &size) == 1) pages = size;
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void send(int pipe, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(pipe, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

// SIGPROF, which nobody handles, ends the process at the end of its processor time.
void limit_time(double seconds) {
  std::signal(SIGPROF, SIG_DFL);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = std::max<suseconds_t>(1, static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds))));
  setitimer(ITIMER_PROF, &timer, nullptr);
}

// Ends without running what the parent has registered to run at its own end.
[[noreturn]] void run_child(int pipe, const RunBudget& budget, const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // it is not to outlive whoever waits for it
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  rlimit space{};
  space.rlim_cur = space.rlim_max = address_space() + budget.bytes;
  setrlimit(RLIMIT_AS, &space);
  limit_time(budget.seconds);
  try {
    const std::string text = work();
    send(pipe, &kDoneByte, 1);
    send(pipe, text.data(), text.size());
  } catch (const std::bad_alloc&) {
    send(pipe, &kMemoryByte, 1);
  } catch (const std::exception& error) {
    send(pipe, &kErrorByte, 1);
    send(pipe, error.what(), std::strlen(error.what()));
  }
  _exit(0);
}

// False when the time is over before the child has closed its end of the pipe.
bool receive(int pipe, Clock::time_point deadline, std::string& message) {
  std::array<char, 4096> buffer{};
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd ready{pipe, POLLIN, 0};
    const int count = left <= 0 ? 0 : poll(&ready, 1, static_cast<int>(std::min<long long>(left, 1000)));
    if (count < 0 && errno != EINTR) fail("poll");
    if (count == 0 && Clock::now() >= deadline) return false;
    if (count <= 0) continue;
    const ssize_t size = read(pipe, buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return true;
    message.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

void tell_end(int status, const std::string& message, GuardedRun& run) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF) {
    run.end = RunEnd::kOutOfTime;
  } else if (WIFSIGNALED(status)) {
    run.end = RunEnd::kCrash;
    run.text = strsignal(WTERMSIG(status));
  } else if (message.empty()) {
    run.end = RunEnd::kCrash;
    run.text = "exit status " + std::to_string(WEXITSTATUS(status));
  } else {
    run.end = message[0] == kDoneByte     ? RunEnd::kDone
              : message[0] == kMemoryByte ? RunEnd::kOutOfMemory
                                          : RunEnd::kError;
    run.text = message.substr(1);
  }
}

}  // namespace

GuardedRun run_guarded(const RunBudget& budget, const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) fail("pipe");
  // What is buffered must not be written twice.
  std::fflush(nullptr);
  const Clock::time_point start = Clock::now();
  const pid_t child = fork();
  if (child < 0) {
    const int error = errno;  // closing may change it
    close(ends[0]);
    close(ends[1]);
    throw std::system_error(error, std::generic_category(), "fork");
  }
  if (child == 0) {
    close(ends[0]);
    run_child(ends[1], budget, work);
  }
  close(ends[1]);
  std::string message;
  // A process that waits for something uses no processor time.
  constexpr double kClockToProcessor = 10;
  const auto time =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kClockToProcessor * budget.seconds));
  const bool in_time = receive(ends[0], start + time, message);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  GuardedRun run;
  run.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  run.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  if (in_time) {
    tell_end(status, message, run);
  } else {
    run.end = RunEnd::kOutOfTime;
  }
  return run;
}

}  // namespace sweepgrid::accuracy
