#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "cli/scene_run.hpp"

namespace sweepgrid {

/// The results of a run for people: one row per scene, printed as the scenes come to their end. Throws
/// std::system_error when it cannot be printed.
class RunTable {
 public:
  /// `out`: stdout or stderr.
  RunTable(std::FILE* out, const std::vector<std::string>& scenes);

  void print_head() const;
  void print_row(const SceneResult& result) const;

 private:
  std::FILE* out_;
  std::size_t name_width_ = 5;
};

/// The last part of a path, without the extensions of recordings, or the generator's text.
[[nodiscard]] std::string short_name(const std::string& scene);

/// "verified: ..." or "NOT verified: ...", without a line end.
[[nodiscard]] std::string verification_text(const Verification& verification);

}  // namespace sweepgrid
