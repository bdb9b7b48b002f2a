#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace sweepgrid {

/// How deeply objects and lists may lie within each other in JSON that the program reads. nlohmann-json copies,
/// compares and prints recursively, so without a bound a file could overflow the stack.
inline constexpr int kDeepestJson = 64;

/// What went wrong, without the library's own numbers.
[[nodiscard]] inline std::string problem_of(const nlohmann::json::exception& error) {
  const std::string text = error.what();
  const std::size_t end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

/// The JSON in `input`, which is a text or a stream. Throws std::invalid_argument that says what is wrong: no JSON, or
/// nested too deeply.
template <class BasicJson, class Input>
[[nodiscard]] BasicJson parse_json(Input&& input) {
  using Event = typename BasicJson::parse_event_t;
  const auto check_depth = [](int depth, Event event, const BasicJson&) {
    const bool starts = event == Event::object_start || event == Event::array_start;
    if (starts && depth >= kDeepestJson) {
      throw std::invalid_argument(fmt::format("nested more than {} levels deep", kDeepestJson));
    }
    return true;
  };
  try {
    return BasicJson::parse(std::forward<Input>(input), check_depth);
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(problem_of(error));
  }
}

/// A member of an object, for readers of what this program has written itself; JsonMembers is for what users write.
/// Throws std::invalid_argument that names the member, and those around it, when it is absent or no Value.
template <class Value>
[[nodiscard]] Value member_of(const nlohmann::json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) throw std::invalid_argument(fmt::format("member '{}' is absent", name));
  try {
    return found->template get<Value>();
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(fmt::format("member '{}': {}", name, problem_of(error)));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("member '{}': {}", name, error.what()));
  }
}

/// The same into `value`.
template <class Value>
void get_member(const nlohmann::json& object, const char* name, Value& value) {
  value = member_of<Value>(object, name);
}

}  // namespace sweepgrid
