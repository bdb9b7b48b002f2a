// Curves over numbers: what ECharts is told of a LineChart.

import {axisText, isNumber, tickText} from "./format.js";
import {colours, seriesColour, symbols} from "./theme.js";

// How each series looks, also in legends: the same in every place.
export function seriesLooks(series) {
  const looks = new Map();
  let next = 0;
  for (const one of series) {
    const like = looks.get(one.like);
    const index = like ? like.index : next++;
    looks.set(one.name, {
      index,
      colour: seriesColour(index),
      symbol: one.style === "fitted" ? undefined : index % symbols.length,
      hollow: one.style === "simulated",
      dash: {measured: "none", simulated: "6 4", fitted: "1 3", front: "none"}[one.style],
    });
  }
  return looks;
}

export const legendText = ({name, style}) =>
  (style === "simulated" && !/simulated/i.test(name) ? `${name} (simulated)` : name);

const canShow = (value, axis) => isNumber(value) && (!axis.log || value > 0);

// The least and the most that an axis must hold.
function extent(chart, side) {
  const axis = chart[side];
  const values = chart.series.flatMap(({points}) => points.flatMap((point) =>
    (side === "x" ? [point.x] : [point.y, point.low, point.high]))).filter((value) => canShow(value, axis));
  return values.length ? [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))] : [1, 10];
}

// Ticks at powers of two where all values are such (threads), else at 1, 2, 5 or powers of ten, as room asks.
function logTicks(chart, side, [low, high]) {
  const isPowerOfTwo = (value) => Number.isInteger(Math.log2(value));
  if (side === "x" && chart.series.every(({points}) => points.every(({x}) => x > 0 && isPowerOfTwo(x)))) {
    const count = Math.log2(high) - Math.log2(low) + 1;
    return Array.from({length: count}, (_, index) => low * 2 ** index);
  }
  const decades = Math.log10(high / low);
  const steps = decades < 1.2 ? [1, 2, 3, 5, 7] : decades < 3.5 ? [1, 2, 5] : [1];
  const stride = decades > 8 ? 2 : 1;
  const ticks = [];
  for (let exponent = Math.floor(Math.log10(low)); exponent <= Math.ceil(Math.log10(high)); exponent += stride) {
    ticks.push(...steps.map((step) => Number(`${step}e${exponent}`)));
  }
  return ticks;
}

// An axis that does not begin at a tick would leave its first stretch without a label.
function logAxis(chart, side) {
  let [low, high] = extent(chart, side);
  if (low === high) [low, high] = [low / 2, high * 2];
  const all = logTicks(chart, side, [low, high]);
  const min = Math.max(...all.filter((tick) => tick <= low * 1.0001), low / 10);
  const max = Math.min(...all.filter((tick) => tick >= high * 0.9999), high * 10);
  const ticks = all.filter((tick) => tick >= min && tick <= max);
  return {
    type: "log",
    min,
    max,
    axisLabel: {customValues: ticks},
    axisTick: {customValues: ticks},
    splitLine: {customValues: ticks},
  };
}

export function axisOption(chart, side) {
  const theme = colours();
  const own = chart[side].log ? logAxis(chart, side) : {type: "value", scale: side === "x"};
  return {
    ...own,
    axisLabel: {...own.axisLabel, color: theme.quiet, fontSize: 12, hideOverlap: true, formatter: tickText},
    axisLine: {show: side === "x", onZero: false, lineStyle: {color: theme.line}},
    axisTick: {...own.axisTick, show: side === "x", lineStyle: {color: theme.line}},
    splitLine: {...own.splitLine, show: true, lineStyle: {color: theme.faint}},
    ...(side === "x" && {name: axisText(chart.x), nameLocation: "middle", nameGap: 28,
      nameTextStyle: {color: theme.quiet, fontSize: 12}, nameTruncate: {maxWidth: 300}}),
    axisPointer: {lineStyle: {color: theme.quiet, type: "solid"}, label: {show: false}},
  };
}

// Points without an order are told apart by their labels. Each is where no earlier one is: beside its point, or as near
// above or below as there is room. One for all series of a chart.
function labelPlaces() {
  const places = new Map();
  const height = 12;
  return ({seriesIndex, dataIndex, labelRect: {x, y, width}}) => {
    const own = `${seriesIndex} ${dataIndex}`;
    if (places.has(own)) places.clear(); // drawn anew
    const taken = (top) => [...places.values()].some((other) => x < other.x + other.width && other.x < x + width &&
      top < other.y + height && other.y < top + height);
    let shift = 0;
    for (let i = 1; i < 200 && (taken(y + shift) || y + shift < 0); ++i) shift = (i % 2 ? 1 : -1) * Math.ceil(i / 2) * 3;
    places.set(own, {x, y: y + shift, width});
    return {dy: shift};
  };
}

const labelsOfPoints = ({points}, labelLayout) => ({
  label: {show: true, color: colours().quiet, fontSize: 10,
    formatter: ({dataIndex}) => points[dataIndex].label ?? ""},
  labelLine: {show: true, length2: 4, lineStyle: {color: colours().line}},
  labelLayout,
});

function curve(one, look, chart, labelLayout) {
  const many = one.points.length > 60;
  const marks = {symbol: look.symbol === undefined ? "none" : symbols[look.symbol], symbolSize: many ? 5 : 8};
  const data = one.points.map(({x, y}) =>
    [canShow(x, chart.x) ? x : "-", canShow(y, chart.y) ? y : "-"]);
  const itemStyle = {color: look.hollow ? colours().paper : look.colour, borderColor: look.colour,
    borderWidth: look.hollow ? 2 : 0};
  const common = {name: one.name, data, ...marks, itemStyle, emphasis: {scale: 1.3},
    z: one.style === "measured" ? 4 : 3};
  if (one.style === "scatter") {
    const [low, high] = extent(chart, "x");
    const sided = data.map((value) => ({value, label: {position: value[0] > (low + high) / 2 ? "left" : "right"}}));
    return {...common, data: sided, type: "scatter", ...labelsOfPoints(one, labelLayout)};
  }
  return {
    ...common,
    type: "line",
    showSymbol: marks.symbol !== "none",
    step: one.style === "front" ? "end" : false,
    lineStyle: {color: look.colour, width: one.style === "fitted" ? 1.5 : 2,
      type: {simulated: [6, 4], fitted: [1.5, 3]}[one.style] ?? "solid"},
  };
}

// From the least to the most of the repetitions.
function errorBars(one, look, chart) {
  const data = one.points.filter(({x, low, high}) => [[x, chart.x], [low, chart.y], [high, chart.y]]
    .every(([value, axis]) => canShow(value, axis))).map(({x, low, high}) => [x, low, high]);
  const renderItem = (_, api) => {
    const [x, top] = api.coord([api.value(0), api.value(2)]);
    const [, bottom] = api.coord([api.value(0), api.value(1)]);
    const line = (x1, y1, x2, y2) => ({type: "line", shape: {x1, y1, x2, y2},
      style: {stroke: look.colour, lineWidth: 1.5}});
    return {type: "group", children: [line(x, top, x, bottom), line(x - 6, top, x + 6, top),
      line(x - 6, bottom, x + 6, bottom)]};
  };
  return {name: one.name, type: "custom", data, renderItem, encode: {x: 0, y: [1, 2]}, silent: true, clip: true, z: 2};
}

export function lineChartSeries(chart) {
  const looks = seriesLooks(chart.series);
  const labelLayout = labelPlaces();
  return [
    ...chart.series.map((one) => curve(one, looks.get(one.name), chart, labelLayout)),
    ...chart.series.filter(({points}) => points.some(({low, high}) => isNumber(low) && isNumber(high)))
      .map((one) => errorBars(one, looks.get(one.name), chart)),
  ];
}
