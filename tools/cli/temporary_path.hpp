#pragma once

#include <atomic>
#include <string>

namespace sweepgrid {

/// The path of a file that must not outlive its owner: removed when this is destroyed, and when a signal that asks the
/// process to end does so: SIGHUP, SIGINT, SIGQUIT, SIGABRT, SIGPIPE, SIGALRM, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU,
/// SIGXFSZ.
/// The process still dies by that signal. Signals that are ignored or handled by somebody else stay so; SIGKILL and
/// crashes leave the file. A forked child removes nothing of its parent's when a signal ends it.
class TemporaryPath {
 public:
  /// To be made before the file is.
  explicit TemporaryPath(std::string path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  [[nodiscard]] const std::string& path() const;

  /// The file has another name now, and nothing is to be removed.
  void release();

 private:
  struct Entry;
  static void install_handlers();
  static void remove_all_and_die(int signal);

  // All that were ever made, for the signal handler: entries are added in front and never freed, so that it can walk
  // them at any moment. A process writes a handful of files.
  static std::atomic<Entry*> entries;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

  Entry* entry_;
};

}  // namespace sweepgrid
