#include "study/report_json.hpp"

#include <chrono>
#include <cmath>

#include <fmt/chrono.h>
#include <nlohmann/json.hpp>

#include "cli/provenance_json.hpp"

namespace sweepgrid::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchemaVersion = 1;

Json number_json(double number) {
  if (std::isnan(number)) return nullptr;
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  return number;
}

// What is absent takes no room: a timeline may have tens of thousands of spans.
void add_number(Json& to, const char* name, const std::optional<double>& number) {
  if (number) to[name] = number_json(*number);
}

void add_text(Json& to, const char* name, const std::string& text) {
  if (!text.empty()) to[name] = text;
}

template <class Item, class ToJson>
Json array_json(const std::vector<Item>& items, const ToJson& to_json) {
  Json array = Json::array();
  for (const Item& item : items) array.push_back(to_json(item));
  return array;
}

const char* style_name(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::kMeasured:
      return "measured";
    case SeriesStyle::kSimulated:
      return "simulated";
    case SeriesStyle::kFitted:
      return "fitted";
    case SeriesStyle::kScatter:
      return "scatter";
    case SeriesStyle::kFront:
      return "front";
  }
  return "";
}

Json axis_json(const Axis& axis) { return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}}; }

Json point_json(const Point& point) {
  Json json = {{"x", number_json(point.x)}, {"y", number_json(point.y)}};
  add_number(json, "low", point.low);
  add_number(json, "high", point.high);
  add_text(json, "label", point.label);
  return json;
}

Json series_json(const Series& series) {
  Json json = {{"name", series.name}, {"style", style_name(series.style)}};
  add_text(json, "like", series.like);
  json["points"] = array_json(series.points, point_json);
  return json;
}

Json chart_json(const LineChart& chart) {
  return {{"id", chart.id},          {"title", chart.title},    {"caption", chart.caption},
          {"x", axis_json(chart.x)}, {"y", axis_json(chart.y)}, {"series", array_json(chart.series, series_json)}};
}

Json tile_json(const Tile& tile) {
  Json json = {{"column", tile.column}, {"row", tile.row}};
  json["value"] = tile.value ? number_json(*tile.value) : Json(nullptr);
  add_number(json, "low", tile.low);
  add_number(json, "high", tile.high);
  add_text(json, "mark", tile.mark);
  add_text(json, "label", tile.label);
  return json;
}

Json map_json(const HeatMap& map) {
  return {{"id", map.id},
          {"title", map.title},
          {"caption", map.caption},
          {"column_label", map.column_label},
          {"row_label", map.row_label},
          {"columns", map.columns},
          {"rows", map.rows},
          {"value", axis_json(map.value)},
          {"tiles", array_json(map.tiles, tile_json)}};
}

Json span_json(const Span& span) {
  Json json = {{"lane", span.lane},
               {"start", number_json(span.start)},
               {"duration", number_json(span.duration)},
               {"group", span.group}};
  add_text(json, "label", span.label);
  return json;
}

Json timeline_json(const Timeline& timeline) {
  return {{"id", timeline.id},       {"title", timeline.title},   {"caption", timeline.caption},
          {"lanes", timeline.lanes}, {"groups", timeline.groups}, {"spans", array_json(timeline.spans, span_json)}};
}

Json cell_json(const Cell& cell) {
  Json json = {{"text", cell.text}};
  add_number(json, "number", cell.number);
  add_number(json, "low", cell.low);
  add_number(json, "high", cell.high);
  return json;
}

Json table_json(const Table& table) {
  const auto row_json = [](const std::vector<Cell>& row) { return array_json(row, cell_json); };
  return {{"id", table.id},
          {"title", table.title},
          {"caption", table.caption},
          {"columns", table.columns},
          {"rows", array_json(table.rows, row_json)}};
}

Json section_json(const Section& section) {
  return {{"title", section.title},
          {"text", section.text},
          {"charts", array_json(section.charts, chart_json)},
          {"maps", array_json(section.maps, map_json)},
          {"timelines", array_json(section.timelines, timeline_json)},
          {"tables", array_json(section.tables, table_json)}};
}

std::string date_text() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace

Json report_json(const Report& report) {
  return {{"schema", "sweepgrid-study"}, {"schema_version", kSchemaVersion},
          {"study", report.study},       {"title", report.title},
          {"summary", report.summary},   {"command", report.command},
          {"date", date_text()},         {"build", build_json()},
          {"machine", machine_json()},   {"sections", array_json(report.sections, section_json)}};
}

}  // namespace sweepgrid::study
