#include "cli/output_file.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/output_place.hpp"

namespace sweepgrid {
namespace {

constexpr mode_t kNewFile = 0666;  // less what the umask takes
constexpr mode_t kPermissions = 0777;

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  OutputPlace place = find_output_place(path_);
  target_ = std::move(place.path);
  switch (place.kind) {
    case OutputPlace::Kind::kDescriptor:
      if (place.descriptor == STDOUT_FILENO) {
        file_ = stdout;
      } else {
        take(fcntl(place.descriptor, F_DUPFD_CLOEXEC, 0));
      }
      return;
    case OutputPlace::Kind::kDevice:
      take(open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
      return;
    case OutputPlace::Kind::kFile:
      break;
  }
  temporary_.emplace(fmt::format("{}.{}.tmp", target_, getpid()));
  take(open(temporary_->path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, kNewFile));
  struct stat replaced {};
  if (stat(target_.c_str(), &replaced) == 0 && fchmod(fileno(file_), replaced.st_mode & kPermissions) != 0) {
    const int error = errno;
    std::fclose(file_);
    fail(error);
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(errno);
}

void OutputFile::commit() {
  if (std::fflush(file_) != 0) fail(errno);
  if (file_ == stdout) return;
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
  if (!temporary_) return;
  if (std::rename(temporary_->path().c_str(), target_.c_str()) != 0) fail(errno);
  temporary_->release();
}

void OutputFile::take(int descriptor) {
  if (descriptor < 0) fail(errno);
  file_ = fdopen(descriptor, "w");
  if (file_ != nullptr) return;
  const int error = errno;
  close(descriptor);
  fail(error);
}

void OutputFile::fail(int error) const {
  const std::string what = is_standard_output(path_) ? "the standard output" : path_;
  throw std::system_error(error, std::generic_category(), "cannot write " + what);
}

}  // namespace sweepgrid
