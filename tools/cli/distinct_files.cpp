#include "cli/distinct_files.hpp"

#include <sys/stat.h>

#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/output_place.hpp"
#include "scenes/generator_params.hpp"

namespace sweepgrid {
namespace {

/// What makes a file one with another.
struct Identity {
  OutputPlace place;
  std::optional<struct stat> node;  // absent: nothing is there yet

  [[nodiscard]] bool is_descriptor(int number) const {
    return place.kind == OutputPlace::Kind::kDescriptor && place.descriptor == number;
  }
};

Identity identity_of(const std::string& path) {
  Identity identity{find_output_place(path), std::nullopt};
  struct stat node {};
  const int failed = identity.place.kind == OutputPlace::Kind::kDescriptor ? fstat(identity.place.descriptor, &node)
                                                                           : stat(identity.place.path.c_str(), &node);
  if (failed == 0) identity.node = node;
  return identity;
}

bool same_node(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && !S_ISCHR(a.st_mode);
}

bool same(const Identity& a, const Identity& b) {
  if (a.place.kind == OutputPlace::Kind::kDescriptor && b.is_descriptor(a.place.descriptor)) return true;
  if (a.node && b.node) return same_node(*a.node, *b.node);
  return !a.node && !b.node && a.place.path == b.place.path;
}

bool is_behind(const Identity& file, int descriptor) {
  struct stat node {};
  return !file.is_descriptor(descriptor) && file.node && fstat(descriptor, &node) == 0 && same_node(*file.node, node);
}

[[noreturn]] void refuse(const NamedFile& a, const NamedFile& b) {
  if (is_standard_output(a.path) && is_standard_output(b.path)) {
    throw std::invalid_argument(fmt::format("{} and {} cannot both be the standard output", a.name, b.name));
  }
  throw std::invalid_argument(fmt::format("{} and {} are the same file: {}{}", a.name, b.name, a.path,
                                          a.path == b.path ? "" : " and " + b.path));
}

}  // namespace

void check_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].path.empty()) continue;
    const Identity output = identity_of(outputs[i].path);
    if (is_behind(output, STDOUT_FILENO)) refuse(outputs[i], {"the standard output", outputs[i].path});
    if (is_behind(output, STDERR_FILENO) && !output.is_descriptor(STDOUT_FILENO)) {
      refuse(outputs[i], {"the standard error", outputs[i].path});
    }
    for (std::size_t k = i + 1; k < outputs.size(); ++k) {
      if (!outputs[k].path.empty() && same(output, identity_of(outputs[k].path))) refuse(outputs[i], outputs[k]);
    }
    for (const NamedFile& input : inputs) {
      if (!input.path.empty() && same(output, identity_of(input.path))) refuse(input, outputs[i]);
    }
  }
}

std::vector<NamedFile> files_among(const std::vector<std::string>& scenes) {
  std::vector<NamedFile> files;
  for (const std::string& scene : scenes) {
    if (!parse_generator(scene)) files.push_back({"SCENE", scene});
  }
  return files;
}

}  // namespace sweepgrid
