#include "cli/output_place.hpp"

#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace sweepgrid {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as Linux follows

// The number of a name in the folder of this process's descriptors. What such a name links to is often no path, and
// where it is one, a new file of that name would not be what the descriptor's owner reads.
std::optional<int> descriptor_of(const fs::path& folder, const std::string& name) {
  if (folder != fmt::format("/proc/{}/fd", getpid())) return std::nullopt;
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return number;
}

fs::path folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  fs::path resolved = fs::weakly_canonical(folder, error);
  return error ? folder : resolved;
}

}  // namespace

OutputPlace find_output_place(const std::string& path) {
  if (path == "-") return {OutputPlace::Kind::kDescriptor, STDOUT_FILENO, ""};
  fs::path at = path;
  for (int links = 0; links <= kMostLinks; ++links) {
    const fs::path folder = folder_of(at);
    at = folder / at.filename();
    if (const auto descriptor = descriptor_of(folder, at.filename().string())) {
      return {OutputPlace::Kind::kDescriptor, *descriptor, ""};
    }
    std::error_code ignored;
    if (!fs::is_symlink(fs::symlink_status(at, ignored))) {
      const fs::file_status status = fs::status(path, ignored);
      if (fs::exists(status) && !fs::is_regular_file(status)) return {OutputPlace::Kind::kDevice, -1, path};
      return {OutputPlace::Kind::kFile, -1, at.string()};
    }
    at = folder / fs::read_symlink(at, ignored);  // an absolute one replaces the folder
  }
  throw std::system_error(std::make_error_code(std::errc::too_many_symbolic_link_levels), "cannot write " + path);
}

bool is_standard_output(const std::string& path) {
  if (path.empty()) return false;
  const OutputPlace place = find_output_place(path);
  return place.kind == OutputPlace::Kind::kDescriptor && place.descriptor == STDOUT_FILENO;
}

}  // namespace sweepgrid
