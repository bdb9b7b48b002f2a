#include "study/point_store.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace sweepgrid::study {

using nlohmann::json;

PointStore::PointStore(const std::filesystem::path& folder, const Fingerprint& fingerprint, Points points)
    : path_(folder / fmt::format("study-{}.points.jsonl", fingerprint.study)),
      fingerprint_(fingerprint.json()),
      digest_(fingerprint.digest()) {
  open();
  try {
    read(points);
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
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0) fail(std::generic_category().message(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  close(file_);
  fail("another study is writing to it");
}

void PointStore::read(Points points) {
  std::ifstream file(path_, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
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
  if (ftruncate(file_, static_cast<off_t>(end)) != 0) fail(std::generic_category().message(errno));
  notes_.push_back(fmt::format("{}: its last line was not written to the end and is dropped", path_.string()));
}

void PointStore::take_line(const std::string& line, std::size_t number, Points points) {
  const json parsed = json::parse(line, nullptr, false);
  const auto text_at = [&](const char* name) {
    return parsed.is_object() && parsed.contains(name) && parsed[name].is_string() ? parsed[name].get<std::string>()
                                                                                   : std::string();
  };
  const std::string digest = text_at("fingerprint");
  if (digest.empty()) {
    notes_.push_back(fmt::format("{}: line {} is no point and is left out", path_.string(), number));
    return;
  }
  if (digest != digest_ || points != Points::kFresh) kept_lines_.push_back(line);
  if (digest == digest_ && points == Points::kFresh) return;
  if (parsed.contains("of")) {
    if (digest == digest_) {
      announced_ = true;
    } else {
      others_.insert_or_assign(digest, parsed["of"]);
    }
  } else if (digest == digest_ && parsed.contains("value")) {
    points_.insert_or_assign(text_at("point"), parsed["value"]);
  }
}

void PointStore::append(const json& line) {
  const std::string text = line.dump() + '\n';
  // One call, so that two lines never mix.
  if (write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + path_.string());
  }
}

void PointStore::rewrite(const std::string& text) {
  // The lock is that of this file, so it is emptied, not replaced.
  if (ftruncate(file_, 0) != 0 || write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + path_.string());
  }
}

void PointStore::fail(const std::string& reason) const {
  throw std::runtime_error(fmt::format("{}: {}", path_.string(), reason));
}

}  // namespace sweepgrid::study
