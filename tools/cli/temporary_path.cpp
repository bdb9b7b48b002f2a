#include "cli/temporary_path.hpp"

#include <csignal>
#include <utility>

#include <unistd.h>

namespace sweepgrid {
namespace {

constexpr int kEndingSignals[] = {SIGHUP,  SIGINT,  SIGQUIT, SIGABRT, SIGPIPE, SIGALRM,
                                  SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
constexpr int kStatusOfSignal = 128;

}  // namespace

struct TemporaryPath::Entry {
  std::string path;
  pid_t owner;
  std::atomic<bool> live;
  Entry* next;
};

static_assert(std::atomic<void*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "the signal handler must not wait for a lock");

std::atomic<TemporaryPath::Entry*> TemporaryPath::entries = nullptr;  // NOLINT(*-avoid-non-const-global-variables)

TemporaryPath::TemporaryPath(std::string path) : entry_(new Entry{std::move(path), getpid(), true, entries.load()}) {
  while (!entries.compare_exchange_weak(entry_->next, entry_)) {
  }
  install_handlers();
}

TemporaryPath::~TemporaryPath() {
  if (entry_->live.exchange(false)) unlink(entry_->path.c_str());
}

const std::string& TemporaryPath::path() const { return entry_->path; }

void TemporaryPath::release() { entry_->live = false; }

void TemporaryPath::install_handlers() {
  for (const int signal : kEndingSignals) {
    struct sigaction present {};
    if (sigaction(signal, nullptr, &present) != 0 || present.sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = &TemporaryPath::remove_all_and_die;
    // Once: raised again from within the handler, the signal then ends the process as if nobody had handled it.
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    sigaction(signal, &action, nullptr);
  }
}

// Calls what POSIX allows in a signal handler, and nothing else.
void TemporaryPath::remove_all_and_die(int signal) {
  const pid_t self = getpid();
  for (const Entry* entry = entries.load(); entry != nullptr; entry = entry->next) {
    if (entry->live.load() && entry->owner == self) unlink(entry->path.c_str());
  }
  raise(signal);
  _exit(kStatusOfSignal + signal);  // the first process of a container does not die by it
}

}  // namespace sweepgrid
