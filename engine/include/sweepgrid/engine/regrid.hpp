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
    met_ = 0;
  }

  /// Tells what the ops of a step met. Few ops say little.
  void observe(double met, std::uint64_t ops) {
    if (ops < 64) return;
    met_ = met / static_cast<double>(ops);
  }

  /// The scene is that crowded or sparse, whatever the cells.
  void resign() { usual_ = met_; }

  [[nodiscard]] bool crowded() const { return met_ > 2.5 * std::max(usual_, target_); }
  [[nodiscard]] bool sparse() const {
    return met_ > 0 && met_ < 0.2 * (usual_ > 0 ? std::min(usual_, target_) : target_);
  }

  /// Twice or a quarter of the objects.
  [[nodiscard]] bool outgrown(std::size_t objects) const {
    return objects > 2 * objects_ || 4 * objects + 64 < objects_;
  }

 private:
  double target_ = 0;
  double usual_ = 0;  // what ops met when no other cells would have been better; 0: there are
  double met_ = 0;    // 0: not yet known
  std::size_t objects_ = 0;
};

}  // namespace sweepgrid
