#pragma once

#include <stdexcept>
#include <string>

namespace sweepgrid {

/// Thrown by validate(): the name of the broken invariant (S1 to S5, G1 to G3, E1 to E3) and what broke it.
class InvariantError : public std::logic_error {
 public:
  InvariantError(const std::string& invariant, const std::string& detail)
      : std::logic_error(invariant + ": " + detail), invariant_(invariant) {}

  [[nodiscard]] const std::string& invariant() const { return invariant_; }

 private:
  std::string invariant_;
};

/// Throws InvariantError unless `holds`. `detail` is called only then.
template <class Detail>
void require_invariant(bool holds, const char* invariant, Detail&& detail) {
  if (!holds) throw InvariantError(invariant, detail());
}

}  // namespace sweepgrid
