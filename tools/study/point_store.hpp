#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "setup/json_text.hpp"
#include "study/fingerprint.hpp"
#include "study/study_options.hpp"

namespace sweepgrid::study {

/// The finished points of a study, in the file study-<study>.points.jsonl of its folder, so that a study that is
/// interrupted loses none: a line of JSON for each, appended and handed to the system as soon as it is measured.
///
/// A line holds the digest of its study's fingerprint, which has a line of its own in front of the first point. Points
/// under another fingerprint (other parameters, program or machine) stay in the file and are never taken.
class PointStore {
 public:
  /// Opens the file and takes the points of the same fingerprint. A last line that was not written to its end is cut
  /// off; lines that are no points are left out. What was found is told by notes().
  /// Throws std::runtime_error that names the file: it cannot be read or written, another process has it open for a
  /// study, or there are no points where `points` is kResume.
  PointStore(const std::filesystem::path& folder, const Fingerprint& fingerprint, Points points);
  ~PointStore();
  PointStore(const PointStore&) = delete;
  PointStore& operator=(const PointStore&) = delete;

  /// Null when the point is not there.
  [[nodiscard]] const nlohmann::json* find(const std::string& key) const;

  /// What `read` makes of the value of a point that is there. Throws std::runtime_error that names the file, the point
  /// and the member when the value is not what `read` expects.
  template <class Read>
  auto read(const std::string& key, const Read& read) const {
    const nlohmann::json* const value = find(key);
    if (value == nullptr) fail_at(key, "is not there");
    try {
      return read(*value);
    } catch (const nlohmann::json::exception& error) {
      fail_at(key, problem_of(error));
    } catch (const std::invalid_argument& error) {
      fail_at(key, error.what());
    }
  }
  template <class Value>
  [[nodiscard]] Value get(const std::string& key) const {
    return read(key, [](const nlohmann::json& value) { return value.get<Value>(); });
  }

  /// Writes a point; when this returns, killing the process does not lose it. Throws std::system_error with the path,
  /// and then the file is as it was.
  void add(const std::string& key, nlohmann::json value);

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// What the user should know of the points that were there, a sentence each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void open();
  void read_lines(Points points);
  [[nodiscard]] std::string read_all() const;
  void cut_torn_line(std::string& text);
  void take_line(const std::string& line, std::size_t number, Points points);
  void append(const nlohmann::json& line);
  void rewrite(const std::string& text);
  [[noreturn]] void fail_at(const std::string& key, const std::string& problem) const;
  [[noreturn]] void fail(const std::string& reason) const;

  std::filesystem::path path_;
  nlohmann::json fingerprint_;
  std::string digest_;
  int file_ = -1;
  bool announced_ = false;  // the fingerprint has its line
  std::map<std::string, nlohmann::json> points_;
  std::map<std::string, nlohmann::json> others_;  // fingerprints by digest
  std::vector<std::string> kept_lines_;           // when points are dropped: the others
  std::vector<std::string> notes_;
};

}  // namespace sweepgrid::study
