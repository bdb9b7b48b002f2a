#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid::scene_files {

/// The objects of one moment.
using Objects = std::map<SceneKey, SceneBox>;

/// A directory of this test's own, gone with it.
class Directory {
 public:
  Directory() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : name) c = c == '/' ? '_' : c;
    path_ = std::filesystem::path(testing::TempDir()) / (name + "." + std::to_string(std::random_device()()));
    std::filesystem::create_directories(path_);
  }
  ~Directory() { std::filesystem::remove_all(path_); }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_file(const std::string& path) {
  std::stringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

inline void append_u32(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

inline void append_aabb(std::string& bytes, const SceneBox& box) {
  for (const auto& corner : {box.min, box.max}) {
    for (const double x : corner) append_u32(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    append_u32(bytes, 0);
  }
}

inline std::string aabbs_header(std::uint32_t objects, std::uint32_t steps) {
  std::string bytes = "Test" + std::string(124, '\0') + "Cubes" + std::string(123, '\0');
  for (const std::uint32_t value : {objects, steps, 0U, 0U}) append_u32(bytes, value);
  append_aabb(bytes, SceneBox({-10, -10, -10}, {10, 10, 10}));
  return bytes;
}

/// As `.aabbs`; the keys must be 0, 1, 2 and so on.
inline std::string as_aabbs(const std::vector<Objects>& frames) {
  std::string bytes =
      aabbs_header(static_cast<std::uint32_t>(frames.front().size()), static_cast<std::uint32_t>(frames.size() - 1));
  for (const Objects& frame : frames) {
    for (const auto& [key, box] : frame) append_aabb(bytes, box);
  }
  return bytes;
}

inline std::string dump_header(std::size_t timestep, std::size_t atoms, const std::string& columns) {
  std::ostringstream text;
  text << "ITEM: TIMESTEP\n"
       << timestep << "\nITEM: NUMBER OF ATOMS\n"
       << atoms << "\nITEM: BOX BOUNDS ff ff ff\n-10 10\n-10 10\n-10 10\nITEM: ATOMS " << columns << "\n";
  return text.str();
}

/// One frame of a LAMMPS dump; the boxes must be cubes. Atoms from the last key to the first.
inline std::string as_dump_frame(const Objects& frame, std::size_t timestep) {
  std::ostringstream text;
  text.precision(17);
  text << dump_header(timestep, frame.size(), "id type x y z radius");
  for (auto object = frame.rbegin(); object != frame.rend(); ++object) {
    const SceneBox& box = object->second;
    text << object->first << " 1";
    for (std::size_t axis = 0; axis < 3; ++axis) text << ' ' << (box.min[axis] + box.max[axis]) / 2;
    text << ' ' << (box.max[0] - box.min[0]) / 2 << "\n";
  }
  return text.str();
}

inline std::string as_dump(const std::vector<Objects>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size(); ++i) text += as_dump_frame(frames[i], 100 * i);
  return text;
}

/// Applies the steps one by one, checks that each makes sense, and returns what each leads to. At most `count` steps.
inline std::vector<Objects> play(SceneSource& source, std::size_t count = 1000) {
  std::vector<Objects> frames;
  Objects objects;
  SceneStep step;
  while (frames.size() < count && source.next(step)) {
    EXPECT_EQ(step.inserted.size(), step.inserted_boxes.size());
    EXPECT_EQ(step.updated.size(), step.updated_boxes.size());
    for (const SceneKey key : step.erased) EXPECT_EQ(objects.erase(key), 1U) << "erased " << key;
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      const auto object = objects.find(step.updated[i]);
      if (object == objects.end()) {
        ADD_FAILURE() << "updated " << step.updated[i] << ", which is not there";
        continue;
      }
      EXPECT_NE(object->second, step.updated_boxes[i]) << "updated " << step.updated[i] << " to the box it had";
      object->second = step.updated_boxes[i];
    }
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      EXPECT_TRUE(objects.emplace(step.inserted[i], step.inserted_boxes[i]).second) << "inserted " << step.inserted[i];
    }
    frames.push_back(objects);
  }
  return frames;
}

inline std::vector<Objects> play(const std::string& spec, const SceneOptions& options = {}) {
  return play(*open_scene(spec, options));
}

/// Opens what a file with these bytes would hold.
inline std::unique_ptr<SceneSource> open_bytes(const std::string& bytes, const SceneOptions& options = {}) {
  return open_recording(std::make_unique<std::stringbuf>(bytes, std::ios::in), "bytes", options);
}

inline void read_to_end(SceneSource& source) {
  for (SceneStep step; source.next(step);) {
  }
}

/// The message with which a scene fails when it is opened, by `open`, or read to its end; empty when it does not.
template <class Open>
std::string failure_of(Open open) {
  try {
    read_to_end(*open());
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}
inline std::string failure(const std::string& spec, const SceneOptions& options = {}) {
  return failure_of([&] { return open_scene(spec, options); });
}
inline std::string bytes_failure(const std::string& bytes, const SceneOptions& options = {}) {
  return failure_of([&] { return open_bytes(bytes, options); });
}

}  // namespace sweepgrid::scene_files
