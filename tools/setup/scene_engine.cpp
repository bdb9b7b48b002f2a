#include "setup/scene_engine.hpp"

#include <cstdint>
#include <stdexcept>

#include <sweepgrid/engine/engine.hpp>

#include "scenes/rounded_step.hpp"
#include "setup/box_conversion.hpp"

namespace sweepgrid {
namespace {

template <class Scalar, int Dim, Door door>
class TypedSceneEngine final : public SceneEngine {
 public:
  using BoxType = Box<Scalar, Dim>;

  TypedSceneEngine(const EngineSetup& setup, const std::vector<std::size_t>& axes)
      : convert_(setup.treatment, axes), engine_(setup.config) {}

  void convert(std::span<const SceneBox> inserted, std::span<const SceneBox> updated) override {
    convert_all(inserted, inserted_);
    convert_all(updated, updated_);
  }

  std::vector<Handle> queue(std::span<const Handle> erased, std::span<const SceneKey> inserted,
                            std::span<const Handle> updated) override {
    if (!erased.empty()) engine_.erase(erased);
    std::vector<Handle> made;
    if (!inserted.empty()) made = engine_.insert(inserted, std::span<const BoxType>(inserted_));
    if (!updated.empty()) engine_.update(updated, std::span<const BoxType>(updated_));
    return made;
  }

  const Events<SceneKey>& step() override {
    const Events<SceneKey>& events = engine_.step();
    if (engine_.status() == StepStatus::kOverBudget) {
      throw std::length_error("the step takes more memory for its lists than step_bytes of the configuration allows");
    }
    return events;
  }

  void as_taken(std::vector<SceneBox>& boxes) const override {
    // By way of memory: g++ 12 leaves the rounding of some ends out where one loop does both.
    std::vector<BoxType> taken;
    convert_all(boxes, taken);
    for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = widen_box<Scalar, Dim>(taken[i]);
  }

  [[nodiscard]] std::vector<Pair<SceneKey>> pairs() const override { return engine_.pairs(); }
  [[nodiscard]] std::size_t size() const override { return engine_.size(); }
  [[nodiscard]] Stats stats() const override { return engine_.stats(); }
  [[nodiscard]] EnvelopeReport envelope_report() const override { return engine_.envelope_report(); }

 private:
  void convert_all(std::span<const SceneBox> boxes, std::vector<BoxType>& converted) const {
    converted.clear();
    for (const SceneBox& box : boxes) converted.push_back(convert_(box));
  }

  BoxConversion<Scalar, Dim, door> convert_;
  Engine<Scalar, Dim, SceneKey> engine_;
  std::vector<BoxType> inserted_;
  std::vector<BoxType> updated_;
};

template <class Scalar, Door door>
std::unique_ptr<SceneEngine> make_of(const EngineSetup& setup, const std::vector<std::size_t>& axes) {
  if (axes.size() == 2) return std::make_unique<TypedSceneEngine<Scalar, 2, door>>(setup, axes);
  return std::make_unique<TypedSceneEngine<Scalar, 3, door>>(setup, axes);
}

}  // namespace

std::unique_ptr<SceneEngine> make_scene_engine(const EngineSetup& setup, int dim) {
  const std::vector<std::size_t> axes = axes_of(setup.treatment, dim);
  switch (setup.treatment.door) {
    case Door::kFloatNearest:
      return make_of<float, Door::kFloatNearest>(setup, axes);
    case Door::kFloatOutward:
      return make_of<float, Door::kFloatOutward>(setup, axes);
    case Door::kInt32:
      return make_of<std::int32_t, Door::kInt32>(setup, axes);
    case Door::kInt16:
      return make_of<std::int16_t, Door::kInt16>(setup, axes);
    case Door::kDouble:
      break;
  }
  return make_of<double, Door::kDouble>(setup, axes);
}

}  // namespace sweepgrid
