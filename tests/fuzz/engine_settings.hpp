#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/scheduler/executor.hpp>

#include "../engine_oracle.hpp"
#include "fuzz_input.hpp"

/// What bytes mean to the engine's target: settings, numbers and boxes.
namespace sweepgrid::fuzz {

/// Objects that live at once are at most as many.
inline constexpr std::size_t kKeys = 40;

/// Executors are made once: starting threads takes longer than a whole program.
inline std::shared_ptr<Executor> shared_executor(int threads) {
  static const std::array executors{make_executor(1), make_executor(2), make_executor(3)};
  return executors.at(static_cast<std::size_t>(threads - 1));
}

inline EnvelopeOptions envelope_options(Input& input) {
  constexpr std::array kMargins{0.0, 0.25, 2.0, 60.0, 1e-3, 1e9};
  constexpr std::array kMarginSteps{0.0, 0.0, 0.5, 1.0, 2.0, 6.0};
  EnvelopeOptions options;
  options.margin = kMargins[input.below(kMargins.size())];
  options.margin_steps = kMarginSteps[input.below(kMarginSteps.size())];
  const std::uint8_t flags = input.byte();
  options.swept = (flags & 1U) != 0;
  options.exact = (flags & 2U) != 0;
  options.on_violation = (flags & 4U) != 0 ? OnViolation::kQuery : OnViolation::kReport;
  options.stride = 1 + (flags >> 3U) % 4;
  return options;
}

/// Whether the engine takes the settings; all others that settings() makes are good.
inline bool good(const std::optional<EnvelopeOptions>& options) {
  return !options || !(options->swept && options->exact);
}

inline std::optional<std::uint64_t> step_bytes(Input& input) {
  constexpr std::array<std::uint64_t, 7> kBytes{1U << 20U, 0, 16, 100, 400, 1600, 6400};
  const std::size_t choice = input.below(2 * kBytes.size());
  return choice < kBytes.size() ? std::nullopt : std::optional(kBytes[choice - kBytes.size()]);
}

template <int Dim>
Config settings(Input& input, oracle::Palette palette, bool may_have_envelope) {
  const CellKind kind = oracle::kKinds[input.below(oracle::kKinds.size())];
  const Reduction reduction = oracle::kReductions[input.below(oracle::kReductions.size())];
  std::size_t grid = input.below(oracle::kGrids.size());
  const std::size_t threads = input.below(4);
  const std::size_t integration = input.below(3);
  std::optional<EnvelopeOptions> envelope;
  if (input.below(2) == 1 && may_have_envelope) envelope = envelope_options(input);
  // Without levels, wide boxes are in millions of cells of a given size.
  const bool far =
      palette == oracle::Palette::kFar || palette == oracle::Palette::kExtremes || palette == oracle::Palette::kFine;
  if (reduction == Reduction::kWitnessCounts && (far || envelope)) grid %= 3;
  // Programs on one thread are the fastest, and only they can fail to get memory.
  const auto executor = shared_executor(threads < 2 ? 1 : static_cast<int>(threads));
  Config config = oracle::kGrids[grid].config<Dim>(kind, executor, reduction);
  config.cell.integration = static_cast<Integration>(integration);
  config.parallel_from = integration == 1 ? 1000 : 0;
  config.envelope = envelope;
  config.step_bytes = step_bytes(input);
  return config;
}

/// Makes boxes on the coordinates of a palette: an axis is a place and a width, a byte each. Wide ones, and bad ones,
/// are rarer than narrow ones.
template <class Scalar, int Dim>
class BoxMaker {
 public:
  explicit BoxMaker(oracle::Palette palette) : values_(oracle::coordinates<Scalar>(palette)) {}

  Box<Scalar, Dim> box(Input& input) const {
    Box<Scalar, Dim> box{};
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(Dim); ++axis) {
      const std::size_t low = input.byte() * (values_.size() - 1) / 255;
      const std::uint8_t width = input.byte();
      std::size_t high = low;
      if (width < 0x80) high += width % 8 * (1 + values_.size() / 128);
      if (width >= 0x80 && width < 0xf8) high += width % 8 * values_.size() / 7;
      box.min[axis] = values_[low];
      box.max[axis] = values_[std::min(high, values_.size() - 1)];
      if (width < 0xf8) continue;
      if constexpr (std::is_floating_point_v<Scalar>) {
        if (width % 2 == 0) box.max[axis] = std::numeric_limits<Scalar>::quiet_NaN();
      }
      if (width % 2 == 1 && low > 0) box.max[axis] = values_[low - 1];
    }
    return box;
  }

 private:
  std::vector<Scalar> values_;
};

/// A margin of an object; bad ones among them.
inline double margin(Input& input) {
  constexpr std::array kMargins{0.0,
                                0.1,
                                1.0,
                                7.0,
                                1e3,
                                1e30,
                                -1.0,
                                std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::quiet_NaN()};
  return kMargins[input.below(kMargins.size())];
}

/// How far an object will go on an axis; bad ones among them.
inline double ahead(Input& input) {
  constexpr std::array kAhead{0.0, 1.0, -1.0, 20.0, -20.0, 1e-3, 1e30, std::numeric_limits<double>::infinity()};
  return kAhead[input.below(kAhead.size())];
}

}  // namespace sweepgrid::fuzz
