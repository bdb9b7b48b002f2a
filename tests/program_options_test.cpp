// What the program takes for a number, and how it refuses what is none.
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/number_text.hpp"
#include "program_run.hpp"

namespace sweepgrid::program_options_test {
namespace {

template <class Number>
std::string refusal(const std::string& text, const NumberRange<Number>& range) {
  try {
    static_cast<void>(number_of(text, range));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(NumberText, IsDecimalAndExact) {
  EXPECT_EQ(number_of<int>("010", {}), 10);
  EXPECT_EQ(number_of<int>("+7", {}), 7);
  EXPECT_EQ(number_of<std::uint64_t>("18446744073709551615", {}), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(number_of<double>("1e-310", {}), 1e-310);
  EXPECT_EQ(number_of<double>("4.9406564584124654e-324", {}), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(number_of<double>("1.7976931348623157e308", {}), std::numeric_limits<double>::max());
  EXPECT_EQ(number_of<int>("auto", {.auto_too = true}), std::nullopt);
}

TEST(NumberText, RefusesTheRestWithTheRange) {
  const NumberRange<int> range{1, 100};
  for (const char* text : {"", " 1", "1 ", "1,0", "0x1", "1e1", "1.5", "+-1", "++1", "true", "0", "101", "-1",
                           "4294967297", "99999999999999999999", "auto"}) {
    EXPECT_EQ(refusal(text, range), fmt::format("'{}' is not a whole number from 1 to 100", text));
  }
  for (const char* text : {"inf", "-inf", "nan", "NaN", "1e309", "1e-400", "0x1p3", "1.5x", "1,5", "-1", "", "+"}) {
    EXPECT_EQ(refusal(text, NumberRange<double>{}),
              fmt::format("'{}' is not a finite number from 0 to 1.79769e+308", text));
  }
  EXPECT_EQ(refusal("0", NumberRange<double>{.without_least = true, .auto_too = true}),
            "'0' is not a positive finite number or 'auto' (numbers go above 0, at most 1.79769e+308)");
}

class ProgramOptions : public ProgramRun {};

TEST_F(ProgramOptions, RefuseWhatIsNoNumberOfTheirRange) {
  const std::pair<std::string, std::string> numbers[] = {
      {"run SCENE --steps", "a whole number from 0 to 18446744073709551615"},
      {"run SCENE --threads", "a whole number from 0 to 65536"},
      {"run SCENE --diameter", "a finite number from 0 to 1.79769e+308"},
      {"run SCENE --cell-size", "a positive finite number or 'auto' (numbers go above 0, at most 1.79769e+308)"},
      {"run SCENE --cell-population", "a positive whole number or 'auto' (numbers go from 1 to 2147483647)"},
      {"run SCENE --segment-capacity", "a whole number from 4 to 65536"},
      {"info SCENE --steps", "a whole number from 0 to 18446744073709551615"},
      {"info SCENE --diameter", "a finite number from 0 to 1.79769e+308"},
      {"tune SCENE --steps", "a whole number from 1 to 18446744073709551615"},
      {"tune SCENE --diameter", "a finite number from 0 to 1.79769e+308"},
      {"tune SCENE --narrow-cost", "a finite number from 0 to 1.79769e+308"},
      {"tune SCENE --threads", "a whole number from 0 to 65536"},
      {"study scaling --threads", "a whole number from 1 to 65536"},
      {"study scaling --simulate", "a whole number from 1 to 4096"},
      {"study accuracy --narrow-cost", "a finite number from 0 to 1.79769e+308"}};
  for (const auto& [command, range] : numbers) {
    std::string arguments = command;
    if (const auto at = arguments.find("SCENE"); at != std::string::npos)
      arguments.replace(at, 5, "uniform:n=9,steps=1");
    const std::string option = command.substr(command.rfind(' ') + 1);
    for (const char* text : {"-1", "1e999"}) {
      const Result result = run(arguments + "=" + text);
      EXPECT_EQ(result.status, 2) << command << text;
      EXPECT_NE(result.err.find(option + ": '" + text + "' is not " + range), std::string::npos) << result.err;
    }
  }
}

TEST_F(ProgramOptions, MayStandBeforeTheSceneAndAfterIt) {
  for (const char* arguments :
       {"run --steps 1 --threads 1 uniform:n=9", "run uniform:n=9 --steps 1 --threads 1",
        "info --diameter 1 uniform:n=9 --steps=1", "run --cell-size auto --steps 1 uniform:n=9"}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 0) << arguments << result.err;
  }
}

TEST_F(ProgramOptions, RefuseOtherNamesThanTheirOwn) {
  for (const auto& [arguments, reason] : std::vector<std::pair<std::string, std::string>>{
           {"run uniform:n=9 --cell 0", "--cell: '0' is none of batch, classic, plane, rows, segmented"},
           {"run uniform:n=9 --scalar 1", "--scalar: '1' is none of double, float"},
           {"run uniform:n=9 --reduction 1", "--reduction: '1' is none of counts, reporter"},
           {"tune uniform:n=9 --truth 1", "--truth: '1' is none of T0, T1, T2"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
  }
}

TEST_F(ProgramOptions, TakeTheLeastAndTheGreatestCellSizes) {
  for (const char* size : {"4.9e-324", "1e-310", "1.7976931348623157e308"}) {
    const Result result =
        run(std::string("run --verify --json - uniform:n=200,steps=3,density=0.2 --cell-size ") + size);
    ASSERT_EQ(result.status, 0) << size << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["settings"]["cell_size"], nlohmann::json::parse(size).get<double>());
    EXPECT_EQ(json["scenes"][0]["verification"]["ok"], true);
  }
}

TEST_F(ProgramOptions, OfGeneratorsNameParameterAndRange) {
  const std::pair<std::string, std::string> cases[] = {
      {"n=1e400", "parameter n: '1e400' is not a number within 1 and 4294967296"},
      {"n=5x", "parameter n: '5x' is not a number within 1 and 4294967296"},
      {"snap=1e-310", "parameter snap: 1e-310 is neither 0 nor at least 1e-30"},
      {"cross=1/1e300", "parameter cross: 1/1e300 is neither 0 nor at least 1e-30"},
      {"speed=inf", "parameter speed: 'inf' is not a number within 0 and 1e+30"},
      {"speed=1e308/1e-308", "parameter speed: 1e308/1e-308 is not within 0 and 1e+30"},
      {"seed=18446744073709551616", "parameter seed: 18446744073709551616 is not a whole number below 2^64"}};
  for (const auto& [parameters, reason] : cases) {
    const Result result = run("run uniform:" + parameters);
    EXPECT_EQ(result.status, 2) << parameters;
    EXPECT_NE(result.err.find("generator uniform: " + reason), std::string::npos) << result.err;
  }
}

TEST_F(ProgramOptions, OfAFileAreRefusedHoweverDeeplyItIsNested) {
  const std::string deep(200000, '[');
  const std::string closed = deep + std::string(200000, ']');
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  const std::pair<std::string, std::string> cases[] = {
      {deep, "nested more than 64 levels deep"},
      {closed, "nested more than 64 levels deep"},
      {objects, "nested more than 64 levels deep"},
      {R"({"tune": )" + closed + "}", "nested more than 64 levels deep"},
      {R"({"schema": )" + std::string(60, '[') + std::string(60, ']') + "}", "setup::schema is [["},
      {R"({"config": {"threads": 2147483647}})", "Config::threads is 2147483647, but must be a whole number"}};
  for (const auto& [setup, reason] : cases) {
    const Result result = run("run uniform:n=10 --config '" + directory_.write("setup.json", setup) + "'");
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("setup.json: "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
  }
  const Result folder = run("run uniform:n=10 --config '" + directory_.path("") + "'");
  EXPECT_NE(folder.err.find("is a directory"), std::string::npos) << folder.err;
}

}  // namespace
}  // namespace sweepgrid::program_options_test
