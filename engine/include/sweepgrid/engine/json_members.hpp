#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace sweepgrid {

namespace json_members {

/// The texts of an enumeration's values: what json_names(Enum), in the namespace of the enumeration, returns.
template <class Enum>
using Names = std::vector<std::pair<std::string_view, Enum>>;

template <class Enum>
[[nodiscard]] std::string name_of(Enum value) {
  for (const auto& [name, candidate] : json_names(value)) {
    if (candidate == value) return std::string(name);
  }
  throw std::invalid_argument("sweepgrid: a setting has a value that has no name");
}

template <class BasicJson, class Value>
[[nodiscard]] BasicJson optional_json(const std::optional<Value>& value) {
  return value ? BasicJson(*value) : BasicJson(nullptr);
}

}  // namespace json_members

/// Reads a JSON object member by member, and refuses what nobody has asked for.
template <class BasicJson>
class JsonMembers {
 public:
  /// `owner`: the struct, for messages.
  JsonMembers(const BasicJson& json, std::string owner) : json_(json), owner_(std::move(owner)) {
    if (!json.is_object())
      throw std::invalid_argument("sweepgrid: " + owner_ + " is " + text(json) + ", not an object");
  }

  void read(const char* name, bool& value) {
    if (const BasicJson* found = find(name)) {
      if (!found->is_boolean()) refuse(name, *found, "true or false");
      value = found->template get<bool>();
    }
  }
  /// A whole number from `least` to `most`.
  template <class Integer>
  requires std::is_integral_v<Integer>
  void read(const char* name, Integer& value, Integer least, Integer most = std::numeric_limits<Integer>::max()) {
    const BasicJson* found = find(name);
    if (found == nullptr) return;
    const auto fits = [&](auto number) {
      return std::in_range<Integer>(number) && static_cast<Integer>(number) >= least &&
             static_cast<Integer>(number) <= most;
    };
    const bool good = found->is_number_unsigned()  ? fits(found->template get<std::uint64_t>())
                      : found->is_number_integer() ? fits(found->template get<std::int64_t>())
                                                   : false;
    if (!good) {
      refuse(name, *found,
             "a whole number of at least " + std::to_string(least) + " and at most " + std::to_string(most));
    }
    value = found->template get<Integer>();
  }
  /// A finite number, not negative; or, without `zero_too`, positive.
  void read(const char* name, double& value, bool zero_too) {
    const BasicJson* found = find(name);
    if (found == nullptr) return;
    const double number = found->is_number() ? found->template get<double>() : -1;
    if (!std::isfinite(number) || !(zero_too ? number >= 0 : number > 0)) {
      refuse(name, *found, zero_too ? "finite and not negative" : "finite and positive");
    }
    value = number;
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void read(const char* name, Enum& value) {
    const BasicJson* found = find(name);
    if (found == nullptr) return;
    std::string known;
    for (const auto& [candidate_name, candidate] : json_names(Enum{})) {
      if (found->is_string() && found->template get<std::string>() == candidate_name) {
        value = candidate;
        return;
      }
      known += (known.empty() ? "\"" : ", \"") + std::string(candidate_name) + "\"";
    }
    refuse(name, *found, "one of " + known);
  }
  /// A struct, which has a from_json() of its own.
  template <class Struct>
  requires std::is_class_v<Struct>
  void read(const char* name, Struct& value) {
    if (const BasicJson* found = find(name)) found->get_to(value);
  }
  template <class Value, class... Range>
  void read(const char* name, std::optional<Value>& value, Range... range) {
    const auto found = json_.find(name);
    if (found != json_.end() && !found->is_null()) {
      read(name, value.emplace(), range...);
    } else {
      known_.emplace_back(name);
      value.reset();
    }
  }
  /// A member that somebody else reads.
  void pass(const char* name) { known_.emplace_back(name); }

  /// To be called last.
  void finish() const {
    for (const auto& [name, value] : json_.items()) {
      bool known = false;
      for (const std::string_view one : known_) known = known || one == name;
      if (!known) throw std::invalid_argument("sweepgrid: " + owner_ + " has no member '" + name + "'");
    }
  }

  [[noreturn]] void refuse(const char* name, const BasicJson& value, const std::string& wanted) const {
    throw std::invalid_argument("sweepgrid: " + owner_ + "::" + name + " is " + text(value) + ", but must be " +
                                wanted);
  }

 private:
  const BasicJson* find(const char* name) {
    known_.emplace_back(name);
    const auto found = json_.find(name);
    return found == json_.end() ? nullptr : &*found;
  }
  // Printing recurses, so what is nested deeply could overflow the stack. And what came from a file may be no UTF-8.
  static std::string text(const BasicJson& json) {
    constexpr int kDeepest = 64;
    if (is_deeper(json, kDeepest)) return "nested more than " + std::to_string(kDeepest) + " levels deep";
    return json.dump(-1, ' ', false, BasicJson::error_handler_t::replace);
  }

  static bool is_deeper(const BasicJson& json, int levels) {
    if (!json.is_structured()) return false;
    return levels == 0 || std::any_of(json.begin(), json.end(),
                                      [levels](const BasicJson& item) { return is_deeper(item, levels - 1); });
  }

  const BasicJson& json_;
  std::string owner_;
  std::vector<std::string_view> known_;
};

}  // namespace sweepgrid
