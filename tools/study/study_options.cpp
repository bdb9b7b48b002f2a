#include "study/study_options.hpp"

#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace sweepgrid::study {

std::filesystem::path make_out_folder(const StudyOptions& options) {
  std::filesystem::path folder = options.out;
  const auto fail = [&](const std::string& reason) {
    throw std::runtime_error(fmt::format("cannot write into the folder {}: {}", folder.string(), reason));
  };
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) fail(error.message());
  if (!std::filesystem::is_directory(folder)) fail("it is no folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0) fail(std::generic_category().message(errno));
  return folder;
}

}  // namespace sweepgrid::study
