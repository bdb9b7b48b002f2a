#include <CGAL/box_intersection_d.h>

#include "system.hpp"

namespace sweepgrid::bench {
namespace {

/// A box as CGAL's boxes must look; by value, because sorting pointers to boxes is slower.
struct NumberedBox {
  using NT = float;
  using ID = std::uint32_t;

  static int dimension() { return 3; }
  [[nodiscard]] ID id() const { return number; }
  [[nodiscard]] NT min_coord(int axis) const { return box.min[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] NT max_coord(int axis) const { return box.max[static_cast<std::size_t>(axis)]; }

  FloatBox box;
  ID number;
};

class CgalSystem final : public System {
 public:
  explicit CgalSystem(std::uint32_t objects) : boxes_(objects), alive_(objects) {}

  void queue(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) alive_[object] = 0;
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      alive_[step.inserted[i]] = 1;
      boxes_[step.inserted[i]] = step.inserted_boxes[i];
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) boxes_[step.updated[i]] = step.updated_boxes[i];
  }

  void step() override {
    sorted_.clear();
    for (std::uint32_t object = 0; object < boxes_.size(); ++object) {
      if (alive_[object] != 0) sorted_.push_back({boxes_[object], object});
    }
    found_.clear();
    CGAL::box_self_intersection_d(
        sorted_.begin(), sorted_.end(),
        [this](const NumberedBox& a, const NumberedBox& b) {
          found_.push_back({a.number, b.number});
        },
        kCutoff, CGAL::Box_intersection_d::CLOSED);
  }

  [[nodiscard]] std::vector<ObjectPair> pairs() const override { return found_; }

 private:
  static constexpr std::ptrdiff_t kCutoff = 10;  // CGAL's default: below, all pairs are scanned

  std::vector<FloatBox> boxes_;  // by object number
  std::vector<char> alive_;      // by object number
  std::vector<NumberedBox> sorted_;
  std::vector<ObjectPair> found_;
};

}  // namespace

std::unique_ptr<System> make_cgal(std::uint32_t objects) { return std::make_unique<CgalSystem>(objects); }

}  // namespace sweepgrid::bench
