#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <fmt/format.h>

namespace sweepgrid {

/// What an option takes: the numbers from `least` to `most`.
template <class Number>
struct NumberRange {
  Number least = 0;
  Number most = std::numeric_limits<Number>::max();
  bool without_least = false;  ///< `least` itself is not taken
  bool auto_too = false;       ///< nor is it a number: "auto"

  [[nodiscard]] bool contains(Number value) const {
    return (without_least ? value > least : value >= least) && value <= most;
  }
};

/// "a whole number from 1 to 7", "a finite number above 0, at most 1e+30".
template <class Number>
[[nodiscard]] std::string text_of(const NumberRange<Number>& range) {
  constexpr bool kWhole = std::is_integral_v<Number>;
  const char* const kind = kWhole ? "whole" : "finite";
  const std::string most =
      kWhole ? fmt::format("{}", range.most) : fmt::format("{:.6}", static_cast<double>(range.most));
  const std::string bounds = range.without_least ? fmt::format("above {}, at most {}", range.least, most)
                                                 : fmt::format("from {} to {}", range.least, most);
  if (!range.auto_too) return fmt::format("a {} number {}", kind, bounds);
  return fmt::format("a positive {} number or 'auto' (numbers go {})", kind, bounds);
}

/// The number that is all of `text`: decimal, in no country's manner, and exact for its type, the least doubles
/// included. Absent for "auto" where the range takes it.
/// Throws std::invalid_argument with the text and what it should have been.
template <class Number>
[[nodiscard]] std::optional<Number> number_of(std::string_view text, const NumberRange<Number>& range) {
  if (range.auto_too && text == "auto") return std::nullopt;
  std::string_view digits = text;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  Number value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  bool good = error == std::errc() && end == digits.data() + digits.size();
  if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
  if (good && range.contains(value)) return value;
  throw std::invalid_argument(fmt::format("'{}' is not {}", text, text_of(range)));
}

}  // namespace sweepgrid
