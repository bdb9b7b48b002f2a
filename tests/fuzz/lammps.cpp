// Bytes as a LAMMPS text dump: every one is refused by name and line, or read; and then read to the same objects
// whatever the ends of lines, and with a diameter given beside the dump's own.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "finding.hpp"
#include "scene_check.hpp"

namespace sweepgrid::fuzz {
namespace {

std::string with_other_line_ends(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

void check_numbers(const Reading& reading) {
  for (const auto& boxes : reading.frames) {
    for (const auto& [key, box] : boxes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        require(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]), "a box that is not finite");
      }
    }
  }
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  const std::string text(data, data + size);
  if (!text.starts_with("ITEM:")) return 0;
  Reading reading = read_all(text, "input.lammpstrj");
  if (!reading.error.empty()) {
    require(reading.error.find("line ") != std::string::npos || reading.error.find("byte ") != std::string::npos,
            "an error without a line: " + reading.error);
    // Without a column for it, the diameter must be told.
    reading = read_all(text, "input.lammpstrj", {.diameter = 0.5});
  }
  check_numbers(reading);
  if (text.find('\r') != std::string::npos) return 0;
  Reading other = read_all(with_other_line_ends(text), "input.lammpstrj", {.diameter = 0.5});
  if (planted("bit") && !other.frames.empty() && !other.frames.back().empty()) {
    double& end = other.frames.back().begin()->second.max[0];
    end = -end;
  }
  require(other.error == reading.error, "other ends of lines are another error: " + other.error);
  require(other.frames == reading.frames, "other ends of lines are other objects");
  return 0;
}
