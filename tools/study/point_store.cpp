#include "study/point_store.hpp"

#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace sweepgrid::study {

using nlohmann::json;

namespace {

std::string message_of(int error) { return std::generic_category().message(error); }

// The error, or 0. A call may take a part only, and that is no error: the next one tells what keeps it from the rest.
int write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(file, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

std::string shortened(const json& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

// What keeps a line from being a point or a fingerprint; empty when nothing does.
std::string problem_of_line(const json& line) {
  if (!line.is_object()) return fmt::format("it must be an object, is {}", shortened(line));
  const auto refused = [&line](const char* name, const char* wanted) {
    const auto found = line.find(name);
    return fmt::format("member '{}' must be {}, is {}", name, wanted,
                       found == line.end() ? "absent" : shortened(*found));
  };
  const auto is_text = [&line](const char* name) {
    const auto found = line.find(name);
    return found != line.end() && found->is_string() && !found->get_ref<const std::string&>().empty();
  };
  if (!is_text("fingerprint")) return refused("fingerprint", "a text");
  if (line.contains("of")) return line["of"].is_object() ? "" : refused("of", "an object");
  if (!is_text("point")) return refused("point", "a text");
  return line.contains("value") ? "" : refused("value", "there");
}

}  // namespace

PointStore::PointStore(const std::filesystem::path& folder, const Fingerprint& fingerprint, Points points)
    : path_(folder / fmt::format("study-{}.points.jsonl", fingerprint.study)),
      fingerprint_(fingerprint.json()),
      digest_(fingerprint.digest()) {
  open();
  try {
    read_lines(points);
  } catch (...) {
    close(file_);
    throw;
  }
}

PointStore::~PointStore() { close(file_); }

const json* PointStore::find(const std::string& key) const {
  const auto point = points_.find(key);
  return point == points_.end() ? nullptr : &point->second;
}

void PointStore::add(const std::string& key, json value) {
  if (!announced_) append({{"fingerprint", digest_}, {"of", fingerprint_}});
  announced_ = true;
  append({{"fingerprint", digest_}, {"point", key}, {"value", value}});
  points_.insert_or_assign(key, std::move(value));
}

void PointStore::open() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, 0644);
  if (file_ < 0) fail(message_of(errno));
  struct stat status {};
  std::string reason;
  if (fstat(file_, &status) != 0) {
    reason = message_of(errno);
  } else if (!S_ISREG(status.st_mode)) {
    reason = "is no regular file";
  } else if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    reason = errno == EWOULDBLOCK ? "another study is writing to it" : "cannot be locked: " + message_of(errno);
  }
  if (reason.empty()) return;
  close(file_);
  fail(reason);
}

void PointStore::read_lines(Points points) {
  std::string text = read_all();
  cut_torn_line(text);
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) take_line(line, ++number, points);
  if (points == Points::kFresh) {
    std::string rest;
    for (const std::string& line : kept_lines_) rest += line + '\n';
    if (rest != text) rewrite(rest);
    return;
  }
  for (const auto& [digest, other] : others_) {
    notes_.push_back(fmt::format("{}: points of another study are not used; it differs in: {}", path_.string(),
                                 differences(other, fingerprint_)));
  }
  if (!points_.empty()) {
    notes_.push_back(
        fmt::format("{}: {} finished points are taken; --fresh measures them anew", path_.string(), points_.size()));
  } else if (points == Points::kResume) {
    const std::string other = notes_.empty() ? "" : fmt::format(" ({})", notes_.back());
    fail(fmt::format("there are no points of this study to resume{}", other));
  }
}

void PointStore::cut_torn_line(std::string& text) {
  if (text.empty() || text.back() == '\n') return;
  const std::size_t end = text.find_last_of('\n') + 1;  // npos + 1 is 0
  text.resize(end);
  if (ftruncate(file_, static_cast<off_t>(end)) != 0) fail(message_of(errno));
  notes_.push_back(fmt::format("{}: its last line was not written to the end and is dropped", path_.string()));
}

void PointStore::take_line(const std::string& line, std::size_t number, Points points) {
  json parsed;
  std::string problem;
  try {
    parsed = parse_json<json>(line);
    problem = problem_of_line(parsed);
  } catch (const std::invalid_argument& error) {
    problem = error.what();
  }
  if (!problem.empty()) {
    notes_.push_back(fmt::format("{}: line {} is no point and is left out: {}", path_.string(), number, problem));
    return;
  }
  const std::string digest = parsed["fingerprint"].get<std::string>();
  if (digest != digest_ || points != Points::kFresh) kept_lines_.push_back(line);
  if (digest == digest_ && points == Points::kFresh) return;
  if (parsed.contains("of")) {
    if (digest == digest_) {
      announced_ = true;
    } else {
      others_.insert_or_assign(digest, parsed["of"]);
    }
  } else if (digest == digest_) {
    points_.insert_or_assign(parsed["point"].get<std::string>(), parsed["value"]);
  }
}

void PointStore::append(const json& line) {
  std::string text;
  try {
    text = line.dump() + '\n';
  } catch (const json::exception& error) {
    fail("a point cannot be written: " + problem_of(error));  // a name that is no UTF-8
  }
  const off_t end = lseek(file_, 0, SEEK_END);
  const int error = write_all(file_, text);
  if (error == 0) return;
  // Half a line would spoil the next one. When it stays, the next study cuts it off.
  static_cast<void>(end < 0 || ftruncate(file_, end) != 0);
  throw std::system_error(error, std::generic_category(), "cannot write " + path_.string());
}

std::string PointStore::read_all() const {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string text;
  while (true) {
    const std::size_t size = text.size();
    text.resize(size + kBlock);
    const ssize_t count = pread(file_, text.data() + size, kBlock, static_cast<off_t>(size));
    if (count < 0 && errno != EINTR) fail("cannot be read: " + message_of(errno));
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count == 0) return text;
  }
}

void PointStore::rewrite(const std::string& text) {
  // The lock is that of this file, so it is emptied, not replaced.
  const int error = ftruncate(file_, 0) != 0 ? errno : write_all(file_, text);
  if (error != 0) throw std::system_error(error, std::generic_category(), "cannot write " + path_.string());
}

void PointStore::fail_at(const std::string& key, const std::string& problem) const {
  fail(fmt::format("point '{}': {}; --fresh measures all anew", key, problem));
}

void PointStore::fail(const std::string& reason) const {
  throw std::runtime_error(fmt::format("{}: {}", path_.string(), reason));
}

}  // namespace sweepgrid::study
