#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sweepgrid::study {

/// What a study found, as data: charts and tables that know nothing of how they are drawn. Written as JSON and as one
/// page of HTML that opens offline.

/// An axis of a chart. `unit` is empty for pure numbers.
struct Axis {
  std::string label;
  std::string unit;
  bool log = false;
};

/// `low` and `high`: the spread of `y` over repetitions (least and most); absent when nothing was repeated. A y of NaN
/// breaks the line.
struct Point {
  double x = 0;
  double y = 0;
  std::optional<double> low = {};
  std::optional<double> high = {};
  std::string label = {};  ///< for the tooltip, beside the numbers; beside marks of kScatter
};

enum class SeriesStyle {
  kMeasured,   ///< marks and a line
  kSimulated,  ///< dashed; the legend says so
  kFitted,     ///< thin line without marks, e.g. a power law
  kScatter,    ///< marks alone
  kFront       ///< steps between marks, e.g. a Pareto front
};

struct Series {
  std::string name;
  SeriesStyle style = SeriesStyle::kMeasured;
  std::vector<Point> points;  ///< by growing x, but for kScatter
  std::string like = {};  ///< the name of an earlier series whose colour and mark it takes: of what it is a fit, say
};

/// Curves over numbers.
struct LineChart {
  std::string id;  ///< [a-z0-9-]+, unique in its report; the anchor in the page
  std::string title;
  std::string caption;  ///< one or two sentences: what was run and what it shows
  Axis x;
  Axis y;
  std::vector<Series> series;
};

/// One tile. `value` absent: nothing was measured, and `mark` says why.
struct Tile {
  std::size_t column = 0;
  std::size_t row = 0;
  std::optional<double> value;
  std::string mark;                ///< drawn into the tile: at most 4 characters
  std::string label;               ///< for the tooltip
  std::optional<double> low = {};  ///< spread of `value`, as a Point's
  std::optional<double> high = {};
};

/// Numbers over two lists of names, as colours.
struct HeatMap {
  std::string id;
  std::string title;
  std::string caption;
  std::string column_label;
  std::string row_label;
  std::vector<std::string> columns;
  std::vector<std::string> rows;
  Axis value;
  std::vector<Tile> tiles;
};

/// A task on a lane of a timeline, seconds from the start.
struct Span {
  std::size_t lane = 0;
  double start = 0;
  double duration = 0;
  std::size_t group = 0;  ///< gives the colour
  std::string label;
};

/// A Gantt chart: what each worker did when.
struct Timeline {
  std::string id;
  std::string title;
  std::string caption;
  std::vector<std::string> lanes;
  std::vector<std::string> groups;
  std::vector<Span> spans;
};

/// Cells that are numbers sort as numbers.
struct Cell {
  std::string text;
  std::optional<double> number = {};
  std::optional<double> low = {};  ///< spread of `number`, as a Point's
  std::optional<double> high = {};
};

struct Table {
  std::string id;
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;
};

/// A heading with what stands under it: text, then charts and tables.
struct Section {
  std::string title;
  std::string text;
  std::vector<LineChart> charts;
  std::vector<HeatMap> maps;
  std::vector<Timeline> timelines;
  std::vector<Table> tables;
};

struct Report {
  std::string study;  ///< "figures", "scaling", ...: names the files study-<study>.json and study-<study>.html
  std::string title;
  std::string summary;
  std::string command;  ///< that makes it again
  std::vector<Section> sections;
};

}  // namespace sweepgrid::study
