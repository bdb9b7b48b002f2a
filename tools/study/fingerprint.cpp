#include "study/fingerprint.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/build_info.hpp"
#include "cli/machine_info.hpp"

namespace sweepgrid::study {
namespace {

std::string fnv1a(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return fmt::format("{:016x}", hash);
}

std::string this_program() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const BuildInfo build = build_info();
  return fmt::format("{} {}", build.commit.empty() ? build.version : build.commit, fnv1a(bytes));
}

// Parameters are too long for a message.
std::string shown(const nlohmann::json& value) { return value.is_string() ? value.get<std::string>() : ""; }

}  // namespace

Fingerprint Fingerprint::here(std::string study, nlohmann::json parameters) {
  const MachineInfo machine = machine_info();
  return {std::move(study), std::move(parameters), this_program(),
          fmt::format("{}, {} cores, {}", machine.cpu, machine.cores, machine.system)};
}

nlohmann::json Fingerprint::json() const {
  return {{"study", study}, {"parameters", parameters}, {"program", program}, {"machine", machine}};
}

std::string Fingerprint::digest() const { return fnv1a(json().dump()); }

std::string differences(const nlohmann::json& then, const nlohmann::json& now) {
  std::vector<std::string> names;
  for (const auto& [name, value] : now.items()) {
    const nlohmann::json before = then.value(name, nlohmann::json());
    if (before == value) continue;
    const std::string old_text = shown(before);
    names.push_back(old_text.empty() ? name : fmt::format("{} ({}; now {})", name, old_text, shown(value)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace sweepgrid::study
