#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <sweepgrid/sap/row_sweep.hpp>

namespace sweepgrid {

/// How space is cut into rows and bins for a sweep from scratch (see RowCut), and what that is chosen by. A bad choice
/// costs time, never a pair: what lies outside of where the scene was when it was fitted is in the outermost cells.
template <class Value, int Dim>
class RowBins {
 public:
  using Cut = RowCut<Value, Dim>;
  /// Everything is in one row.
  RowBins() { cut_.scale.fill(std::numeric_limits<Value>::min()); }
  [[nodiscard]] const Cut& cut() const { return cut_; }
  [[nodiscard]] std::uint32_t bins() const { return bins_; }
  [[nodiscard]] std::uint32_t rows() const { return rows_; }

  /// The cells of what holds two boxes, by axis.
  struct Span {
    std::array<std::int32_t, Dim> low;
    std::array<std::int32_t, Dim> high;
  };
  /// `a`, `b`: the mins of a box, then its maxes.
  [[nodiscard]] Span span(const Value* a, const Value* b) const {
    Span span;
    for (int axis = 0; axis < Dim; ++axis) {
      span.low[axis] = cell(std::min(a[axis], b[axis]), axis);
      span.high[axis] = cell(std::max(a[Dim + axis], b[Dim + axis]), axis);
    }
    return span;
  }

  /// In how many rows it is.
  [[nodiscard]] std::size_t rows_of(const Span& span) const {
    std::size_t rows = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      if (axis != cut_.along) rows *= static_cast<std::size_t>(span.high[axis] - span.low[axis]) + 1;
    }
    return rows;
  }
  /// The first of them.
  [[nodiscard]] std::uint32_t first_row(const Span& span) const {
    std::uint32_t row = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      if (axis != cut_.along) row += static_cast<std::uint32_t>(span.low[axis]) * cut_.stride[axis];
    }
    return row;
  }
  /// Calls `visit(row, marks)` for each of them; `marks`: bits of row_marks::kEarlier.
  template <class Visit>
  void for_each_row(const Span& span, Visit&& visit) const {
    // Of each row axis.
    std::array<std::uint32_t, 3> more{};
    std::array<std::uint32_t, 3> stride{};
    const std::uint32_t first = first_row(span);
    for (int axis = 0, used = 0; axis < Dim; ++axis) {
      if (axis == cut_.along) continue;
      more[used] = static_cast<std::uint32_t>(span.high[axis] - span.low[axis]);
      stride[used++] = cut_.stride[axis];
    }
    constexpr std::uint32_t kFirst = row_marks::kFirstEarlier;
    for (std::uint32_t z = 0; z <= more[2]; ++z) {
      for (std::uint32_t y = 0; y <= more[1]; ++y) {
        for (std::uint32_t x = 0; x <= more[0]; ++x) {
          visit(first + x * stride[0] + y * stride[1] + z * stride[2],
                (x != 0 ? kFirst : 0) | (y != 0 ? 2 * kFirst : 0) | (z != 0 ? 4 * kFirst : 0));
        }
      }
    }
  }

  /// What a fit goes by: where a scene is, and how wide its boxes are.
  class Scene {
   public:
    static constexpr std::size_t kSample = 256;
    /// `boxes`: of a sample of at most kSample, mins and then maxes.
    explicit Scene(std::span<const std::array<Value, 2 * Dim>> boxes);
    /// To be called with every box.
    void add(const Value* box) {
      std::array<double, Dim> width;
      for (int axis = 0; axis < Dim; ++axis) {
        const double edge = static_cast<double>(box[Dim + axis]) - static_cast<double>(box[axis]);
        const double share = edge * inverse_extent_[axis];
        width[axis] = share < 1 ? share : 1;  // of the scene's; NaN for a box at infinity
      }
      ++moments_[0];
      for (std::size_t set = 1; set < moments_.size(); ++set) {
        double product = 1;
        for (int axis = 0; axis < Dim; ++axis) product *= (set >> axis & 1) != 0 ? width[axis] : 1;
        moments_[set] += product;
      }
    }

   private:
    friend class RowBins;
    struct Ends {
      double lower;
      double upper;
    };
    /// Where most of these are, which are sorted.
    static Ends core(std::span<const double> sorted);

    std::array<double, Dim> lower_{};
    std::array<double, Dim> extent_{};
    std::array<double, Dim> inverse_extent_{};
    std::array<double, Dim> usual_width_{};
    // Of each set of axes: the sum over all boxes of the product of their widths, as shares of the scene's extent.
    std::array<double, std::size_t{1} << Dim> moments_{};
  };

  /// Fits to a scene. `crowding`: how many times as many members a row's members met in the latest sweep as they
  /// would in a scene that is spread evenly.
  static RowBins fit(const Scene& scene, double crowding);
  /// What a fit weighs: in about nanoseconds, with AVX-512 and floats.
  static constexpr double kEntryCost = 7;
  static constexpr double kMeetingCost = 0.12;
  /// Rows along one axis, and so many on each of the others.
  static RowBins of(const Scene& scene, int along, std::array<std::uint32_t, Dim> rows);

  /// What is to be expected of a sweep in a scene that is spread evenly: entries in rows, and members that they meet.
  [[nodiscard]] double expected_entries() const { return entries_; }
  [[nodiscard]] double expected_meetings() const { return meetings_; }
  /// What fit() is to be told after a sweep that counted this.
  [[nodiscard]] double crowding(double entries, double meetings) const {
    const double expected = meetings_ * entries / std::max(1.0, entries_);
    return std::clamp(meetings / std::max(1.0, expected), 0.25, 1024.0);
  }

 private:
  [[nodiscard]] std::int32_t cell(Value value, int axis) const {
    Value place = value * cut_.scale[axis];
    place = place + cut_.offset[axis];
    return static_cast<std::int32_t>(std::min(std::max(place, Value{0}), cut_.last[axis]));
  }

  /// With so many rows on each axis but one.
  struct Estimate {
    double entries;
    double meetings;
  };
  static Estimate estimate(const Scene& scene, int along, const std::array<std::uint32_t, Dim>& rows);

  Cut cut_{};
  std::uint32_t bins_ = 1;
  std::uint32_t rows_ = 1;
  double entries_ = 0;
  double meetings_ = 0;
};

template <class Value, int Dim>
RowBins<Value, Dim>::Scene::Scene(std::span<const std::array<Value, 2 * Dim>> boxes) {
  constexpr double kMost = std::numeric_limits<Value>::max() / 16;
  std::array<double, kSample> lower;
  std::array<double, kSample> widths;
  const auto count = static_cast<std::ptrdiff_t>(boxes.size());
  for (int axis = 0; axis < Dim; ++axis) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const auto at = [&](int value) { return std::clamp(static_cast<double>(boxes[i][value]), -kMost, kMost); };
      lower[i] = at(axis);
      widths[i] = at(Dim + axis) - at(axis);
    }
    std::sort(lower.begin(), lower.begin() + count);
    std::nth_element(widths.begin(), widths.begin() + count / 2, widths.begin() + count);
    const auto [least, most] = core(std::span(lower).first(boxes.size()));
    const double width = boxes.empty() ? 0 : widths[boxes.size() / 2];
    const double slack = (most - least) / 30;
    lower_[axis] = least - slack;
    // A scene without any extent has some all the same, so that there is something to divide by.
    const double tiny = std::max(std::abs(least), std::abs(most)) * 1e-6 + std::numeric_limits<float>::min();
    extent_[axis] = std::max(most + slack + width - lower_[axis], tiny);
    inverse_extent_[axis] = 1 / extent_[axis];
    usual_width_[axis] = std::max(width, extent_[axis] * 1e-7);
  }
}

// Who is far off shares the outermost cells, and meets all others there: so few may be left out, and only where the
// others get much more room by it.
template <class Value, int Dim>
auto RowBins<Value, Dim>::Scene::core(std::span<const double> sorted) -> Ends {
  constexpr double kShare = 0.3;  // of the objects that may be left out on a side
  constexpr double kPrice = 8;    // to leave out a share s, the rest must lie in exp(-kPrice * s) of the room
  if (sorted.empty()) return {0, 0};
  const auto most_out = static_cast<std::size_t>(kShare * static_cast<double>(sorted.size()));
  std::array<double, 2 * kSample> price;  // by how many are left out
  for (std::size_t out = 0; out <= 2 * most_out; ++out) {
    price[out] = std::exp(kPrice * static_cast<double>(out) / static_cast<double>(sorted.size()));
  }
  Ends best{sorted.front(), sorted.back()};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t below = 0; below <= most_out; ++below) {
    for (std::size_t above = 0; above <= most_out; ++above) {
      const Ends ends{sorted[below], sorted[sorted.size() - 1 - above]};
      const double cost = (ends.upper - ends.lower) * price[below + above];
      if (cost < least) {
        least = cost;
        best = ends;
      }
    }
  }
  return best;
}

template <class Value, int Dim>
auto RowBins<Value, Dim>::estimate(const Scene& scene, int along, const std::array<std::uint32_t, Dim>& rows)
    -> Estimate {
  // A box is in 1 + width / cell rows of an axis. The product over the axes, summed over all boxes, is a sum over
  // sets of axes.
  double entries = 0;
  double lengths = 0;
  double count = 1;
  for (int axis = 0; axis < Dim; ++axis) count *= axis == along ? 1 : rows[axis];
  for (std::size_t set = 0; set < scene.moments_.size(); ++set) {
    if ((set >> along & 1) != 0) continue;
    double product = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      if ((set >> axis & 1) != 0) product *= rows[axis] > 1 ? rows[axis] : 0;
    }
    entries += product * scene.moments_[set];
    lengths += product * scene.moments_[set | std::size_t{1} << along];
  }
  lengths += entries * scene.usual_width_[along] * scene.inverse_extent_[along] / 4;  // a bin
  return {entries, entries / count * lengths};
}

template <class Value, int Dim>
auto RowBins<Value, Dim>::fit(const Scene& scene, double crowding) -> RowBins {
  constexpr double kFiner = 0.8;
  constexpr std::uint32_t kMostRows = 4096;  // on an axis
  constexpr double kLeastObjects = 4;        // for each row
  const double objects = std::max(1.0, scene.moments_[0]);
  int best_along = 0;
  double least = std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, Dim> best_rows;
  best_rows.fill(1);
  for (int along = 0; along < Dim; ++along) {
    std::array<std::uint32_t, Dim> rows{};
    for (double size = *std::max_element(scene.extent_.begin(), scene.extent_.end()) * 2;; size *= kFiner) {
      double count = 1;
      bool finest = true;
      for (int axis = 0; axis < Dim; ++axis) {
        const double wanted = axis == along ? 1 : scene.extent_[axis] / size + 0.5;
        rows[axis] = static_cast<std::uint32_t>(std::clamp<double>(wanted, 1, kMostRows));
        finest = finest && (axis == along || rows[axis] == kMostRows);
        count *= rows[axis];
      }
      if (count > 1 && (finest || count * kLeastObjects > objects)) break;
      const Estimate estimated = estimate(scene, along, rows);
      const double cost = kEntryCost * estimated.entries + kMeetingCost * crowding * estimated.meetings;
      if (cost < least) {
        least = cost;
        best_along = along;
        best_rows = rows;
      }
      if (Dim == 1) break;
    }
  }
  return of(scene, best_along, best_rows);
}

template <class Value, int Dim>
auto RowBins<Value, Dim>::of(const Scene& scene, int along, std::array<std::uint32_t, Dim> rows) -> RowBins {
  constexpr std::uint32_t kMostBins = 1 << 23;
  const double objects = std::max(1.0, scene.moments_[0]);
  RowBins bins;
  const Estimate estimated = estimate(scene, along, rows);
  bins.entries_ = estimated.entries;
  bins.meetings_ = estimated.meetings;
  Cut& cut = bins.cut_;
  cut.along = along;
  for (int axis = 0; axis < Dim; ++axis) {
    if (axis == along) continue;
    cut.stride[axis] = bins.rows_;
    bins.rows_ *= rows[axis];
  }
  const double wanted = scene.extent_[along] / (scene.usual_width_[along] / 4) + 1;
  const double most = std::min(1 + 4 * objects / bins.rows_, static_cast<double>(kMostBins));
  bins.bins_ = rows[along] = static_cast<std::uint32_t>(std::min(wanted, most));
  for (int axis = 0; axis < Dim; ++axis) {
    const double scale = rows[axis] / scene.extent_[axis];
    // Neither 0 nor infinite, lest an infinite coordinate become NaN.
    using Limits = std::numeric_limits<Value>;
    cut.scale[axis] = static_cast<Value>(std::clamp<double>(scale, Limits::min(), Limits::max()));
    cut.offset[axis] = static_cast<Value>(-scene.lower_[axis] * cut.scale[axis]);
    cut.last[axis] = static_cast<Value>(rows[axis] - 1);
  }
  return bins;
}

}  // namespace sweepgrid
