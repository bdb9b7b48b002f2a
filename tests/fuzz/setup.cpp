// Bytes as the JSON of a setup, and of a library's Config: refused by name, or taken; and then what is written of it is
// taken again as the same, and the engine takes the settings.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include <sweepgrid/engine/config_json.hpp>
#include <sweepgrid/engine/engine.hpp>

#include "finding.hpp"
#include "setup/setup_json.hpp"

namespace sweepgrid::fuzz {
namespace {

using Json = nlohmann::ordered_json;

void check_engine(Config config) {
  config.executor = make_serial_executor();
  // A cell of a higher capacity takes its memory at once.
  config.cell.segment_capacity = std::min(config.cell.segment_capacity, 1 << 10);
  Engine<float, 2> engine(config);
  engine.insert(1, {{0, 0}, {1, 1}});
  engine.insert(2, {{1, 1}, {2, 2}});
  engine.set_step_bytes({});
  engine.step();
  require(engine.pairs().size() == 1, "an engine with settings from JSON finds another number of pairs");
}

void check(const EngineSetup& setup) {
  Json written = setup_json(setup);
  if (planted("bit")) written["config"]["threads"] = setup.config.threads ^ 1;
  const Json again = setup_json(setup_of(Json::parse(written.dump())));
  require(setup_json(setup) == again, "a setup that is written and read is another: " + again.dump());
  check_engine(setup.config);
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid;        // NOLINT(google-build-using-namespace)
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  Json json;
  try {
    json = Json::parse(data, data + size);
  } catch (const Json::exception&) {
    return 0;
  }
  std::optional<EngineSetup> setup;
  try {
    setup = setup_of(json);
  } catch (const std::invalid_argument& error) {
    require(std::string(error.what()).starts_with("sweepgrid: "),
            std::string("a refusal without a name: ") + error.what());
  }
  if (setup) check(*setup);
  std::optional<Config> config;
  try {
    config = json.get<Config>();
  } catch (const std::invalid_argument&) {
  }
  if (config) check_engine(*config);
  return 0;
}
