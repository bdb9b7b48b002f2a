// Bytes as the file of a study's finished points: opening it refuses by name or takes what is whole, loses nothing of
// other studies, and what is added is there the next time. The first byte chooses whether points are kept or dropped.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "finding.hpp"
#include "fuzz_input.hpp"
#include "study/point_store.hpp"

namespace sweepgrid::fuzz {
namespace {

using study::Points;
using study::PointStore;

/// A folder of this process's own, in memory where there is such a place; gone with the process.
class Folder {
 public:
  Folder() {
    const std::filesystem::path memory = "/dev/shm";
    std::error_code error;
    const bool is_there = access(memory.c_str(), W_OK) == 0;
    path_ = (is_there ? memory : std::filesystem::temp_directory_path(error)) /
            ("sweepgrid-fuzz-points-" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Null when the file is refused.
std::unique_ptr<PointStore> open(const std::filesystem::path& folder, Points points) {
  // Its digest, for inputs to have: 075d5756c60730af.
  const study::Fingerprint fingerprint{"fuzz", nlohmann::json::object(), "program", "machine"};
  try {
    return std::make_unique<PointStore>(folder, fingerprint, points);
  } catch (const std::runtime_error& error) {
    require(std::string(error.what()).starts_with((folder / "study-fuzz.points.jsonl").string()),
            std::string("an error that does not name the file: ") + error.what());
    return nullptr;
  }
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  static const Folder folder;
  const std::filesystem::path path = folder.path() / "study-fuzz.points.jsonl";
  Input input({data, size});
  const auto points = static_cast<Points>(input.below(3));
  const std::string text = input.rest();
  std::ofstream(path, std::ios::binary) << text;
  const std::string whole = text.substr(0, text.find_last_of('\n') + 1);
  std::size_t known = 0;
  {
    auto store = open(folder.path(), points);
    if (!store) return 0;
    require(points != Points::kFresh || store->size() == 0, "points that were to be dropped are there");
    require(points == Points::kFresh || content_of(path) == whole, "a file that is opened has changed");
    require(store->path() == path, "path() is wrong");
    store->add("added", {{"ms", 1.5}});
    known = store->size();
  }
  const std::string written = content_of(path);
  const auto again = open(folder.path(), Points::kResume);
  require(again != nullptr, "a file with a point is refused");
  require(again->size() == known, "points are lost");
  const nlohmann::json* const added = again->find("added");
  require(added != nullptr && *added == nlohmann::json{{"ms", planted("bit") ? 1.75 : 1.5}},
          "a point is not what was added");
  require(content_of(path) == written, "a file that is opened again has changed");
  return 0;
}
