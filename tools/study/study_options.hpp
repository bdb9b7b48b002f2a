#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace sweepgrid::study {

/// What becomes of points that an earlier run of the same study left in the folder.
enum class Points {
  kKeep,    ///< taken where there are any, and said so
  kResume,  ///< taken; an error when there are none
  kFresh    ///< dropped, and measured anew
};

/// Options that all studies have.
struct StudyOptions {
  std::string out = ".";  ///< folder of all that the study writes; made when it is absent
  bool quick = false;     ///< a rough answer within a minute
  Points points = Points::kKeep;
};

/// SIGINT or SIGTERM ended a study between two points; what() tells where the points are.
class Interrupted : public std::runtime_error {
 public:
  Interrupted(int signal, const std::string& what) : std::runtime_error(what), signal_(signal) {}

  /// As a shell tells of a program that the signal ends.
  [[nodiscard]] int exit_status() const { return 128 + signal_; }

 private:
  int signal_;
};

/// Makes the folder, with those above it. Throws std::runtime_error that names it when that fails or when nothing can
/// be written into it: before a study, not after.
[[nodiscard]] std::filesystem::path make_out_folder(const StudyOptions& options);

}  // namespace sweepgrid::study
