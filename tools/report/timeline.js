// What each worker did when: what ECharts is told of a Timeline.

import {graphic} from "echarts/core";
import {numberText, timeScale} from "./format.js";
import {colours, isPrinting, seriesColour} from "./theme.js";

const laneHeight = (timeline) => Math.min(28, Math.max(7, 640 / timeline.lanes.length));
export const timelineHeight = (timeline) => Math.round(timeline.lanes.length * laneHeight(timeline)) + 90;

export const timelineScale = ({spans}) =>
  timeScale(spans.reduce((longest, {start, duration}) => Math.max(longest, start + duration), 0));

// The spans of each group, which is a series of its own so that legends can switch it.
export function spansByGroup(timeline) {
  const groups = timeline.groups.map(() => []);
  for (const span of timeline.spans) groups[span.group]?.push(span);
  return groups;
}

function spanItem(colour) {
  return (params, api) => {
    const [x, y] = api.coord([api.value(1), api.value(0)]);
    const [end] = api.coord([api.value(2), api.value(0)]);
    const height = api.size([0, 1])[1] * 0.8;
    const area = params.coordSys;
    // Where spans touch, a gap tells them apart.
    const width = Math.max((end - x) * 0.88, end - x - 1, 0.5);
    const shape = graphic.clipRectByRect({x, y: y - height / 2, width, height},
      {x: area.x, y: area.y, width: area.width, height: area.height});
    return shape && {type: "rect", shape, style: {fill: colour}, emphasis: {style: {opacity: 0.7}}};
  };
}

export function timelineOption(timeline) {
  const theme = colours();
  const lane = laneHeight(timeline);
  const {unit, perSecond} = timelineScale(timeline);
  return {
    grid: {left: 8, right: 20, top: 8, bottom: 34, outerBoundsMode: "same", outerBoundsContain: "all"},
    xAxis: {
      type: "value",
      name: `time (${unit})`,
      nameLocation: "middle",
      nameGap: 28,
      nameTextStyle: {color: theme.quiet, fontSize: 12},
      min: 0,
      max: "dataMax",
      axisLabel: {color: theme.quiet, fontSize: 12, hideOverlap: true, showMaxLabel: false,
        formatter: (value) => numberText(value, 4)},
      axisLine: {show: true, lineStyle: {color: theme.line}},
      axisTick: {show: true, lineStyle: {color: theme.line}},
      splitLine: {lineStyle: {color: theme.faint}},
    },
    yAxis: {
      type: "category",
      data: timeline.lanes,
      inverse: true,
      axisLabel: {color: theme.ink, fontSize: lane < 14 ? 10 : 12, overflow: "truncate", width: 110,
        interval: Math.ceil(12 / lane) - 1},
      axisLine: {show: false},
      axisTick: {show: false},
      splitLine: {show: false},
    },
    // The wheel alone scrolls the page.
    dataZoom: [
      {type: "inside", filterMode: "weakFilter", zoomOnMouseWheel: "ctrl", moveOnMouseWheel: false},
      {type: "slider", show: !isPrinting(), filterMode: "weakFilter", height: 18, bottom: 6, showDetail: false,
        brushSelect: false, borderColor: theme.line, fillerColor: `${theme.series[0]}33`, backgroundColor: theme.faint,
        dataBackground: {lineStyle: {opacity: 0}, areaStyle: {opacity: 0}},
        selectedDataBackground: {lineStyle: {opacity: 0}, areaStyle: {opacity: 0}}},
    ],
    series: spansByGroup(timeline).map((spans, group) => ({
      name: timeline.groups[group],
      type: "custom",
      renderItem: spanItem(seriesColour(group)),
      encode: {x: [1, 2], y: 0},
      data: spans.map(({lane, start, duration}) => [lane, start * perSecond, (start + duration) * perSecond]),
    })),
  };
}
