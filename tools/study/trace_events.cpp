#include "study/trace_events.hpp"

#include <utility>

#include <nlohmann/json.hpp>

namespace sweepgrid::study {
namespace {

using Json = nlohmann::json;

constexpr double kMicro = 1e6;

Json name_event(const char* what, std::size_t process, std::size_t lane, const std::string& name) {
  return {{"ph", "M"}, {"name", what}, {"pid", process}, {"tid", lane}, {"args", {{"name", name}}}};
}

}  // namespace

std::string trace_events(const std::vector<TraceProcess>& processes) {
  Json events = Json::array();
  for (std::size_t p = 0; p < processes.size(); ++p) {
    const TraceProcess& process = processes[p];
    events.push_back(name_event("process_name", p, 0, process.name));
    for (std::size_t lane = 0; lane < process.lanes.size(); ++lane) {
      events.push_back(name_event("thread_name", p, lane, process.lanes[lane]));
    }
    for (const TraceSlice& slice : process.slices) {
      events.push_back({{"ph", "X"},
                        {"name", slice.name},
                        {"cat", slice.category},
                        {"pid", p},
                        {"tid", slice.lane},
                        {"ts", kMicro * slice.start},
                        {"dur", kMicro * slice.duration}});
    }
  }
  // Names of files need not be UTF-8.
  return Json{{"traceEvents", std::move(events)}, {"displayTimeUnit", "ns"}}.dump(-1, ' ', false,
                                                                                  Json::error_handler_t::replace);
}

}  // namespace sweepgrid::study
