// The files that fuzzing has left in corpus/ find nothing, and would find faults that are planted in what they are
// compared with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "finding.hpp"

#define TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
SWEEPGRID_FUZZ_TARGETS
#undef TARGET

namespace sweepgrid::fuzz {
namespace {

struct Target {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);
};

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {
#define TARGET(name) {#name, fuzz_##name},
      SWEEPGRID_FUZZ_TARGETS
#undef TARGET
  };
  return all;
}

std::vector<std::filesystem::path> files_of(const Target& target) {
  const std::filesystem::directory_iterator folder(std::filesystem::path(SWEEPGRID_FUZZ_CORPUS) / target.name);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : folder) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// What the target finds; nothing when all is well.
std::string replay(const Target& target, const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  try {
    target.run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

std::size_t findings(const Target& target, const std::string& fault) {
  planted_fault() = fault;
  const auto files = files_of(target);
  const auto found =
      std::count_if(files.begin(), files.end(), [&](const auto& path) { return !replay(target, path).empty(); });
  planted_fault().clear();
  return static_cast<std::size_t>(found);
}

class FuzzCorpus : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, FindsNothing) {
  const auto files = files_of(GetParam());
  EXPECT_GE(files.size(), 5U);
  for (const auto& path : files) EXPECT_EQ(replay(GetParam(), path), "") << path;
}

TEST_P(FuzzCorpus, FindsABitThatIsPlantedInWhatIsExpected) { EXPECT_GT(findings(GetParam(), "bit"), 0U); }

TEST(FuzzCorpusOfTheEngine, FindsAPairThatBruteForceLacks) { EXPECT_GT(findings({"engine", fuzz_engine}, "pair"), 0U); }

std::string name_of(const ::testing::TestParamInfo<Target>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpus, ::testing::ValuesIn(targets()), name_of);

}  // namespace
}  // namespace sweepgrid::fuzz
