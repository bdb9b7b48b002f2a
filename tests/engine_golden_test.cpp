// Small scenes with the events that were looked at and found right: the contract by example.
//
// A file of golden/ is read as it is checked: `+ key box`, `~ key box` and `- key` queue an insert, an update and an
// erase, `step` begins a step, and the `end` and `begin` lines after its ops are what the engine said. After a change
// of the ops, or for a new file without events, write the events with
//
//   SWEEPGRID_UPDATE_GOLDEN=1 build/dev/bin/engine_golden_test
//
// and read the difference. Red is legitimate only when the ops of the file or the contract of events (closed boxes, net
// change of a step, order) were changed on purpose; never because of another cell, grid, thread count or machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <sweepgrid/engine/engine.hpp>

namespace sweepgrid::engine_golden_test {
namespace {

std::string path_of(const std::string& name) { return SWEEPGRID_SOURCE_DIR "/tests/golden/" + name + ".txt"; }

std::string read(const std::string& name) {
  std::ifstream file(path_of(name));
  if (!file) throw std::runtime_error("cannot read " + path_of(name));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

template <class Scalar, int Dim>
Box<Scalar, Dim> read_box(std::istringstream& words) {
  std::array<Scalar, 2 * Dim> numbers{};
  for (Scalar& number : numbers) {
    std::string word;
    words >> word;
    number = static_cast<Scalar>(std::stod(word));  // a stream would not read "inf"
  }
  Box<Scalar, Dim> box;
  std::copy_n(numbers.begin(), Dim, box.min.begin());
  std::copy_n(numbers.begin() + Dim, Dim, box.max.begin());
  return box;
}

/// The file's text with the events that an engine of these settings says.
template <class Scalar, int Dim>
std::string replayed(const std::string& text, const Config& config) {
  Engine<Scalar, Dim> engine(config);
  std::istringstream lines(text);
  std::ostringstream out;
  bool in_step = false;
  const auto finish_step = [&] {
    if (!in_step) return;
    const Events<std::uint64_t>& events = engine.step();
    for (const auto& pair : events.ends) out << "end " << pair.first << " " << pair.second << "\n";
    for (const auto& pair : events.begins) out << "begin " << pair.first << " " << pair.second << "\n";
    engine.validate();
  };
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string what;
    std::uint64_t key = 0;
    words >> what >> key;
    if (what == "end" || what == "begin") continue;
    if (what == "step") finish_step(), in_step = true;
    out << line << "\n";
    if (what == "+") engine.insert(key, read_box<Scalar, Dim>(words));
    if (what == "~") engine.update(key, read_box<Scalar, Dim>(words));
    if (what == "-") engine.erase(key);
  }
  finish_step();
  return out.str();
}

template <class Scalar, int Dim>
void check(const std::string& name, const std::string& text) {
  Config config;
  config.threads = 1;
  if (std::getenv("SWEEPGRID_UPDATE_GOLDEN") != nullptr) {
    std::ofstream(path_of(name)) << replayed<Scalar, Dim>(text, config);
    GTEST_SKIP() << "wrote " << path_of(name);
  }
  for (const CellKind kind :
       {CellKind::kRows, CellKind::kBatch, CellKind::kSegmented, CellKind::kClassic, CellKind::kPlane}) {
    for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
      for (const int population : {1, 48}) {
        config.cell.kind = kind;
        config.reduction = reduction;
        config.cell_population = population;
        EXPECT_EQ((replayed<Scalar, Dim>(text, config)), text)
            << "kind " << static_cast<int>(kind) << ", population " << population << ", reduction "
            << static_cast<int>(reduction);
      }
    }
  }
}

class EngineGolden : public ::testing::TestWithParam<const char*> {};

TEST_P(EngineGolden, EventsAreThoseThatWereFoundRight) {
  const std::string text = read(GetParam());
  if (text.find("space float 2\n") != std::string::npos) {
    check<float, 2>(GetParam(), text);
  } else if (text.find("space double 3\n") != std::string::npos) {
    check<double, 3>(GetParam(), text);
  } else {
    FAIL() << "the file does not say its space";
  }
}

INSTANTIATE_TEST_SUITE_P(Files, EngineGolden, ::testing::Values("closed_boxes", "within_a_step", "growing_scene"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace sweepgrid::engine_golden_test
