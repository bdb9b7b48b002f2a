#pragma once

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sweepgrid::fuzz {

/// Something is wrong. Nobody catches it in a fuzzer, which then ends, keeps the input and prints the text.
class Finding : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void require(bool good, std::string_view what) {
  if (!good) throw Finding(std::string(what));
}

/// The fault that is planted in what targets compare with: "pair" drops one pair of the brute force, "bit" flips a bit
/// of what is expected. None by default. With one, targets must find something at once, or they check nothing.
/// From the environment variable SWEEPGRID_PLANTED_FAULT; tests set it here.
inline std::string& planted_fault() {
  static std::string fault = [] {
    const char* const value = std::getenv("SWEEPGRID_PLANTED_FAULT");
    return std::string(value == nullptr ? "" : value);
  }();
  return fault;
}

[[nodiscard]] inline bool planted(std::string_view fault) { return planted_fault() == fault; }

}  // namespace sweepgrid::fuzz
