#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace sweepgrid {

/// When a scene has outgrown its cells. Judges by what ops meet in their cells, which is what they cost, and by the
/// number of objects.
class Regrid {
 public:
  /// `met`: residents that an op is expected to meet in its cell.
  void fitted(double met, std::size_t objects) {
    target_ = std::max(met, 8.0);
    objects_ = std::max<std::size_t>(objects, 32);
    usual_ = 0;
  }

  /// To the same target.
  void refitted() { usual_ = 0; }

  /// Tells what the ops of a step met. Few ops say little.
  void observe(double met, std::uint64_t ops) {
    if (ops < 64) return;
    met_ = met / static_cast<double>(ops);
    if (usual_ == 0) usual_ = met_;
  }

  /// The scene is that crowded, whatever the cells.
  void resign() { usual_ = met_; }

  [[nodiscard]] bool crowded() const { return usual_ > 0 && met_ > 2.5 * std::max(usual_, target_); }
  [[nodiscard]] bool sparse() const { return usual_ > 0 && met_ < 0.2 * std::min(usual_, target_); }

  /// Twice or a quarter of the objects.
  [[nodiscard]] bool outgrown(std::size_t objects) const {
    return objects > 2 * objects_ || 4 * objects + 64 < objects_;
  }

  /// By how much cells should be wider or narrower, in steps of a twelfth of an octave and at most two octaves.
  [[nodiscard]] double factor(int dim) const {
    constexpr double kStep = 1.0594630943592953;  // 2^(1/12); no call to pow, whose last bit differs between machines
    const double wanted = target_ / std::max(met_, 0.1);
    const double step = wanted > 1 ? kStep : 1 / kStep;
    double factor = 1;
    double reached = 1;  // factor to the power of dim
    for (int i = 0; i < 24 && (wanted > 1 ? reached < wanted : reached > wanted); ++i) {
      factor *= step;
      for (int axis = 0; axis < dim; ++axis) reached *= step;
    }
    return factor;
  }

 private:
  double target_ = 0;
  double usual_ = 0;  // what ops met right after the fit; 0: not yet known
  double met_ = 0;
  std::size_t objects_ = 0;
};

}  // namespace sweepgrid
