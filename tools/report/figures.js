// Each figure of a report: its heading, legend, chart, caption and numbers.

import {init, use} from "echarts/core";
import {CustomChart, LineChart, ScatterChart} from "echarts/charts";
import {DataZoomInsideComponent, DataZoomSliderComponent, GridComponent, LegendComponent, TooltipComponent,
  VisualMapContinuousComponent} from "echarts/components";
import {LabelLayout} from "echarts/features";
import {CanvasRenderer, SVGRenderer} from "echarts/renderers";
import {element, inline} from "./dom.js";
import {axisText, isNumber, numberText, spreadText, withUnit} from "./format.js";
import {heatMapHeight, heatMapOption, heatMapWidth} from "./heat_map.js";
import {axisOption, legendText, lineChartSeries, seriesLooks} from "./line_chart.js";
import {tableElement} from "./table.js";
import {colours, isPrinting, onThemeChange, seriesColour, swatch} from "./theme.js";
import {spansByGroup, timelineHeight, timelineOption, timelineScale} from "./timeline.js";

use([CanvasRenderer, CustomChart, DataZoomInsideComponent, DataZoomSliderComponent, GridComponent, LabelLayout,
  LegendComponent, LineChart, SVGRenderer, ScatterChart, TooltipComponent, VisualMapContinuousComponent]);

// As many rectangles as a browser moves at ease when each is an element of the page.
const kMostElements = 4000;
// What fits on A4 and letter.
const kPrintWidth = 660;

const drawings = [];

// Draws all charts again when the colours change; at once, since a page that is being printed does not wait.
onThemeChange(() => drawings.forEach((draw) => draw()));
export const redrawAll = () => drawings.forEach((draw) => draw());

const tip = (head, rows) => element("div", {class: "tip"}, head && element("b", {}, head),
  ...rows.map(([mark, name, value]) => element("div", {}, mark ?? "", element("span", {}, name),
    element("em", {}, value))));

// Puts a chart into `holder` and keeps it at the holder's width, of which `height` and `option` are functions.
function draw(holder, height, option, renderer = "svg") {
  const widthNow = () => (isPrinting() ? kPrintWidth : holder.clientWidth || kPrintWidth);
  let width = widthNow();
  const chart = init(holder, null,
    {renderer, width, height: height(width), devicePixelRatio: Math.max(2, devicePixelRatio)});
  const {fontFamily} = getComputedStyle(document.body);
  const redraw = () => {
    width = widthNow();
    holder.style.height = `${height(width)}px`;
    chart.resize({width, height: height(width)});
    chart.setOption({animation: false, textStyle: {fontFamily}, ...option(width)});
    chart.getZr().flush();
  };
  redraw();
  drawings.push(redraw);
  new ResizeObserver(() => {
    if (!isPrinting() && holder.clientWidth && holder.clientWidth !== width) redraw();
  }).observe(holder);
  return chart;
}

// Buttons that switch series. ECharts' own legend cannot be reached with the keyboard.
function legendOf(names, texts, mark) {
  const buttons = names.map((name, index) =>
    element("button", {type: "button", "aria-pressed": "true"}, mark(index), texts[index]));
  return {
    legend: element("div", {class: "legend", role: "group", "aria-label": "Series"}, ...buttons),
    connect(chart) {
      buttons.forEach((button, index) => button.addEventListener("click", () =>
        chart.dispatchAction({type: "legendToggleSelect", name: names[index]})));
      chart.on("legendselectchanged", ({selected}) => buttons.forEach((button, index) =>
        button.setAttribute("aria-pressed", String(selected[names[index]]))));
      drawings.push(() => buttons.forEach((button, index) => button.firstChild.replaceWith(mark(index))));
    },
  };
}

const hiddenLegend = (names) => ({show: false, data: names});

function tooltip(option) {
  const theme = colours();
  return {confine: true, backgroundColor: theme.paper, borderColor: theme.line, padding: [8, 10],
    textStyle: {color: theme.ink, fontSize: 13}, transitionDuration: 0, ...option};
}

// The figure around a chart; `make` is called once the figure is in the page.
function figure(kind, item, {label, above, below, table, wide, minWidth}, make) {
  const holder = element("div", {class: "chart", role: "img", "aria-label": label});
  if (minWidth) holder.style.minWidth = `${minWidth}px`;
  const details = table && element("details", {}, element("summary", {}, "Numbers"));
  details?.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(tableElement(table()));
  });
  const scroll = minWidth ?
    element("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": item.title}, holder) : holder;
  const whole = element("figure", {id: item.id, class: `${kind}${wide ? " wide" : ""}`},
    element("h3", {}, element("a", {href: `#${item.id}`}, ...inline(item.title))), above, scroll, below,
    element("figcaption", {}, ...inline(item.caption)), details);
  return {element: whole, start: () => make(holder)};
}

const numberCell = (value) => (isNumber(value) ? {text: numberText(value, 6), number: value} : {text: ""});

function pointsTable(chart) {
  return {
    title: chart.title,
    columns: ["series", axisText(chart.x), axisText(chart.y), "least", "most", "note"],
    rows: chart.series.flatMap((one) => one.points.map(({x, y, low, high, label}) =>
      [{text: legendText(one)}, numberCell(x), numberCell(y), numberCell(low), numberCell(high), {text: label ?? ""}])),
  };
}

function lineTip(chart, looks, params) {
  const hits = [params].flat().filter(({seriesIndex}) => seriesIndex < chart.series.length);
  if (!hits.length) return "";
  const point = ({seriesIndex, dataIndex}) => chart.series[seriesIndex].points[dataIndex];
  return tip(`${chart.x.label} ${withUnit(numberText(point(hits[0]).x), chart.x.unit)}`, hits.map((hit) => {
    const one = chart.series[hit.seriesIndex];
    const {y, low, high, label} = point(hit);
    const value = spreadText({value: y, low, high}, chart.y.unit);
    return [swatch(looks.get(one.name)), legendText(one), label ? `${value}, ${label}` : value];
  }));
}

export function lineChartFigure(chart) {
  const names = chart.series.map(({name}) => name);
  const look = (index) => swatch(seriesLooks(chart.series).get(names[index]));
  const {legend, connect} = legendOf(names, chart.series.map(legendText), look);
  const isScatter = chart.series.some(({style}) => style === "scatter");
  const option = () => ({
    grid: {left: 2, right: 14, top: 12, bottom: 4, outerBoundsMode: "same", outerBoundsContain: "all"},
    legend: hiddenLegend(names),
    tooltip: tooltip({trigger: isScatter ? "item" : "axis",
      formatter: (params) => lineTip(chart, seriesLooks(chart.series), params)}),
    xAxis: axisOption(chart, "x"),
    yAxis: axisOption(chart, "y"),
    series: lineChartSeries(chart),
  });
  const label = `${chart.title}. ${axisText(chart.y)} over ${axisText(chart.x)} for ` +
    `${chart.series.map(legendText).join(", ")}.`;
  return figure("line", chart, {label, table: () => pointsTable(chart),
    above: element("div", {}, legend, element("p", {class: "axis"}, axisText(chart.y)))},
  (holder) => connect(draw(holder, () => 340, option)));
}

function tilesTable(map) {
  return {
    title: map.title,
    columns: [map.row_label, map.column_label, axisText(map.value), "least", "most", "mark", "note"],
    rows: map.tiles.map(({column, row, value, low, high, mark, label}) => [{text: map.rows[row] ?? ""},
      {text: map.columns[column] ?? ""}, numberCell(value), numberCell(low), numberCell(high), {text: mark ?? ""},
      {text: label ?? ""}]),
  };
}

export function heatMapFigure(map) {
  const formatter = ({dataIndex}) => {
    const tile = map.tiles[dataIndex];
    const value = tile.value === null ? "not measured" : spreadText(tile, map.value.unit);
    return tip(`${map.rows[tile.row]}, ${map.columns[tile.column]}`,
      [[undefined, map.value.label, value], ...(tile.label ? [[undefined, tile.label, ""]] : [])]);
  };
  const label = `${map.title}. ${axisText(map.value)} for ${map.rows.length} by ${map.columns.length} tiles.`;
  return figure("map", map, {label, table: () => tilesTable(map), wide: true, minWidth: heatMapWidth(map),
    above: element("p", {class: "axis"}, axisText(map.value))},
  (holder) => draw(holder, (width) => heatMapHeight(map, width),
    (width) => ({...heatMapOption(map, width), tooltip: tooltip({trigger: "item", formatter})})));
}

export function timelineFigure(timeline) {
  const {unit, perSecond} = timelineScale(timeline);
  const groups = spansByGroup(timeline);
  const look = (index) => swatch({colour: seriesColour(index), box: true});
  const {legend, connect} = legendOf(timeline.groups, timeline.groups, look);
  const formatter = ({seriesIndex, dataIndex}) => {
    const {lane, start, duration, group, label} = groups[seriesIndex][dataIndex];
    const time = (seconds) => `${numberText(seconds * perSecond)} ${unit}`;
    return tip(label || timeline.groups[group], [[look(group), timeline.groups[group], timeline.lanes[lane]],
      [undefined, "from", time(start)], [undefined, "takes", time(duration)]]);
  };
  const label = `${timeline.title}. ${timeline.spans.length} spans on ${timeline.lanes.length} lanes.`;
  const hint = element("p", {class: "hint"}, "Drag the slider's ends, or turn the wheel with Ctrl held, to zoom.");
  return figure("timeline", timeline, {label, wide: true, above: legend, below: hint},
    (holder) => connect(draw(holder, () => timelineHeight(timeline), () => ({...timelineOption(timeline),
      legend: hiddenLegend(timeline.groups), tooltip: tooltip({trigger: "item", formatter})}),
    timeline.spans.length > kMostElements ? "canvas" : "svg")));
}
