#include "setup/guarantee.hpp"

namespace sweepgrid {

using accuracy::TruthKind;

std::string guarantee_name(Guarantee guarantee) {
  switch (guarantee) {
    case Guarantee::kExact:
      return "exact";
    case Guarantee::kSuperset:
      return "superset only";
    case Guarantee::kMayMiss:
      break;
  }
  return "may miss";
}

Guarantee guarantee(const EngineSetup& setup, const SceneInfo& scene, TruthKind truth, bool outside) {
  const EnvelopeOptions envelope = setup.config.envelope.value_or(EnvelopeOptions{});
  if (outside && envelope.stride > 1 && envelope.on_violation == OnViolation::kReport) return Guarantee::kMayMiss;
  if (truth == TruthKind::kMotion) {
    return envelope.swept && envelope.stride == 1 ? Guarantee::kSuperset : Guarantee::kMayMiss;
  }
  if (truth == TruthKind::kShapes && scene.shapes != ShapeKind::kBoxes) return Guarantee::kSuperset;
  // The format holds floats: float is as good as double.
  const bool as_given =
      setup.treatment.door == Door::kDouble || (is_float(setup.treatment.door) && scene.format == "aabbs");
  const bool all_axes = static_cast<int>(axes_of(setup.treatment, scene.dim).size()) >= scene.dim;
  const bool exact = as_given && all_axes && (!setup.config.envelope || envelope.exact);
  return exact ? Guarantee::kExact : Guarantee::kSuperset;
}

}  // namespace sweepgrid
