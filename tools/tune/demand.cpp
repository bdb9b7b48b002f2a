#include "tune/demand.hpp"

#include <charconv>

#include <fmt/format.h>

namespace sweepgrid::tune {

std::string truth_name(accuracy::TruthKind truth) { return fmt::format("T{}", static_cast<int>(truth)); }

std::string demand_text(const Demand& demand) {
  const std::string missed =
      demand.missed > 0 ? fmt::format("at most {:.4g} % missed", 100 * demand.missed) : "none missed, by a guarantee";
  const std::string extra = !demand.extra       ? "extra ones charged"
                            : *demand.extra > 0 ? fmt::format("at most {:.4g} % extra", 100 * *demand.extra)
                                                : "none extra, by a guarantee";
  return fmt::format("pairs of {}: {}, {}", truth_name(demand.truth), missed, extra);
}

double parse_part(const std::string& text) {
  const bool percent = text.ends_with('%');
  const char* const last = text.data() + text.size() - (percent ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (percent) value /= 100;
  if (error != std::errc() || end != last || !(value >= 0 && value <= 1)) {
    throw std::invalid_argument(fmt::format("'{}' is no part: give 5% or 0.05, at most 100%", text));
  }
  return value;
}

}  // namespace sweepgrid::tune
