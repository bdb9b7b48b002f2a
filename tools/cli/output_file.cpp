#include "cli/output_file.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace sweepgrid {

OutputFile::OutputFile(std::string path) : path_(std::move(path)), target_(path_) {
  namespace fs = std::filesystem;
  if (path_ == "-") {
    file_ = stdout;
    return;
  }
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(path_, error);
  if (!error) target_ = resolved.string();
  // Renaming over a device would replace it.
  const bool replaceable = !fs::exists(target_, error) || fs::is_regular_file(target_, error);
  if (replaceable) temporary_ = fmt::format("{}.{}.tmp", target_, getpid());
  file_ = std::fopen((replaceable ? temporary_ : target_).c_str(), "w");
  if (file_ == nullptr) {
    temporary_.clear();
    fail();
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void OutputFile::commit() {
  if (std::fflush(file_) != 0) fail();
  if (file_ == stdout) return;
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail();
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
  temporary_.clear();
}

void OutputFile::fail() const { throw std::system_error(errno, std::generic_category(), "cannot write " + path_); }

}  // namespace sweepgrid
