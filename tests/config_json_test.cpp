// Settings as JSON: that nothing is lost on the way, and what is refused.
#include <sweepgrid/engine/config_json.hpp>

#include <memory>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sweepgrid/engine/engine.hpp>

namespace sweepgrid::config_json_test {
namespace {

using Json = nlohmann::json;

// Every member has another value than its default.
Config changed_everywhere() {
  Config config;
  config.cell = {CellKind::kSegmented, 8, Integration::kPresorted};
  config.cell_size = 0.1;
  config.cell_population = 7;
  config.reduction = Reduction::kWitnessCounts;
  config.step_method = StepMethod::kSweep;
  config.envelope = EnvelopeOptions{1.0 / 3, 2.5, false, 4, OnViolation::kQuery, true};
  config.step_bytes = 10'000'000'000;
  config.threads = 3;
  config.parallel_from = 17;
  return config;
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(Json::parse(text).get<Config>());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigJson, TellsEveryMember) {
  EXPECT_EQ(Json(changed_everywhere()), Json::parse(R"({
    "cell": {"kind": "segmented", "segment_capacity": 8, "integration": "presorted"},
    "cell_size": 0.1, "cell_population": 7, "reduction": "counts", "step_method": "sweep",
    "envelope": {"margin": 0.3333333333333333, "margin_steps": 2.5, "swept": false, "stride": 4,
                 "on_violation": "query", "exact": true},
    "step_bytes": 10000000000, "threads": 3, "parallel_from": 17})"));
  EXPECT_EQ(Json(Config{}), Json::parse(R"({
    "cell": {"kind": "rows", "segment_capacity": 32, "integration": "auto"},
    "cell_size": null, "cell_population": null, "reduction": "reporter", "step_method": "auto", "envelope": null,
    "step_bytes": null, "threads": 0, "parallel_from": 1000})"));
}

TEST(ConfigJson, ComesBackAsItWas) {
  for (const Config& config : {changed_everywhere(), Config{}}) {
    const Json json = config;
    EXPECT_EQ(Json(Json::parse(json.dump()).get<Config>()), json);
    EXPECT_EQ(Json(nlohmann::ordered_json(config).get<Config>()), json) << "in order";
  }
  const Config back = Json(changed_everywhere()).get<Config>();
  EXPECT_EQ(back.envelope->margin, 1.0 / 3) << "to the last bit";
  EXPECT_TRUE(back.envelope->exact);
}

TEST(ConfigJson, WhatIsAbsentHasItsDefault) {
  Config config = changed_everywhere();
  config.executor = make_executor(1);
  const std::shared_ptr<Executor> executor = config.executor;
  Json::parse(R"({"envelope": {"margin": 2}})").get_to(config);
  EXPECT_EQ(config.executor, executor) << "an executor has no JSON";
  Config expected;
  expected.envelope = EnvelopeOptions{.margin = 2};
  EXPECT_EQ(Json(config), Json(expected));
  const Engine<float, 3> engine(config);
  EXPECT_EQ(engine.envelope_report().margin, 2);
}

TEST(ConfigJson, RefusesWhatItDoesNotKnowAndNamesIt) {
  const std::pair<const char*, const char*> cases[] = {
      {"[]", "Config is [], not an object"},
      {R"({"cell-size": 1})", "Config has no member 'cell-size'"},
      {R"({"executor": null})", "Config has no member 'executor'"},
      {R"({"cell_size": 0})", "Config::cell_size is 0, but must be finite and positive"},
      {R"({"cell_size": 1e999})", "number overflow"},
      {R"({"cell_size": "1"})", "Config::cell_size is \"1\""},
      {R"({"cell_population": 0})", "Config::cell_population is 0, but must be a whole number of at least 1"},
      {R"({"cell_population": 2.5})", "Config::cell_population is 2.5"},
      {R"({"cell_population": 4294967297})", "Config::cell_population is 4294967297"},
      {R"({"cell_population": 18446744073709551615})", "Config::cell_population is 18446744073709551615"},
      {R"({"step_bytes": -1})", "Config::step_bytes is -1, but must be a whole number of at least 0"},
      {R"({"threads": -1})", "Config::threads is -1, but must be a whole number of at least 0"},
      {R"({"threads": 65537})", "Config::threads is 65537, but must be a whole number of at least 0 and at most 65536"},
      {R"({"threads": null})", "Config::threads is null"},
      {R"({"reduction": "sum"})", "Config::reduction is \"sum\", but must be one of \"reporter\", \"counts\""},
      {R"({"reduction": 1})", "Config::reduction is 1"},
      {R"({"cell": null})", "CellOptions is null, not an object"},
      {R"({"cell": {"kinds": 1}})", "CellOptions has no member 'kinds'"},
      {R"({"cell": {"kind": "round"}})", "CellOptions::kind is \"round\""},
      {R"({"cell": {"segment_capacity": 3}})", "CellOptions::segment_capacity is 3, but must be"},
      {R"({"cell": {"segment_capacity": 65537}})",
       "is 65537, but must be a whole number of at least 4 and at most 65536"},
      {R"({"cell": {"integration": true}})", "CellOptions::integration is true"},
      {R"({"envelope": {"margins": 1}})", "EnvelopeOptions has no member 'margins'"},
      {R"({"envelope": {"margin": -1}})", "EnvelopeOptions::margin is -1, but must be finite and not negative"},
      {R"({"envelope": {"margin": null}})", "EnvelopeOptions::margin is null"},
      {R"({"envelope": {"margin_steps": "2"}})", "EnvelopeOptions::margin_steps is \"2\""},
      {R"({"envelope": {"swept": 1}})", "EnvelopeOptions::swept is 1, but must be true or false"},
      {R"({"envelope": {"stride": 0}})", "EnvelopeOptions::stride is 0, but must be a whole number of at least 1"},
      {R"({"envelope": {"on_violation": "crash"}})", "EnvelopeOptions::on_violation is \"crash\""},
      {R"({"envelope": {"exact": true, "swept": true}})", "EnvelopeOptions::exact is true, but must be false"},
  };
  for (const auto& [text, reason] : cases) {
    std::string found;
    try {
      found = refusal(text);
    } catch (const Json::exception& error) {
      found = error.what();
    }
    EXPECT_NE(found.find(reason), std::string::npos) << text << "\nexpected: " << reason << "\nfound: " << found;
  }
  EXPECT_EQ(refusal("{}"), "");
}

// Of any depth: JSON that a client has parsed may hold more levels than a recursion can follow.
TEST(ConfigJson, RefusesWhatIsNestedDeeplyWithoutFollowingIt) {
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  for (const char* name : {"cell", "cell_size", "cell_population", "reduction", "envelope", "step_bytes", "threads"}) {
    const std::string found = refusal("{\"" + std::string(name) + "\": " + deep + "}");
    EXPECT_NE(found.find(" is nested more than 64 levels deep, "), std::string::npos) << found;
  }
  EXPECT_EQ(refusal(deep), "sweepgrid: Config is nested more than 64 levels deep, not an object");
  EXPECT_EQ(refusal("{\"depth\": " + deep + "}"), "sweepgrid: Config has no member 'depth'");
}

TEST(ConfigJson, ARefusalChangesNothing) {
  Config config = changed_everywhere();
  const Json before = config;
  EXPECT_THROW(Json::parse(R"({"threads": 1, "cell_population": 0})").get_to(config), std::invalid_argument);
  EXPECT_EQ(Json(config), before);
}

}  // namespace
}  // namespace sweepgrid::config_json_test
