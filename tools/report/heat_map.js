// Numbers over two lists of names: what ECharts is told of a HeatMap.

import {isNumber, numberText} from "./format.js";
import {colours, heat} from "./theme.js";

const kGap = 2;
const kNamesWidth = 130;
const longestName = (names) => Math.max(...names.map((name) => name.length), 1);
const areTurned = (map, width) => longestName(map.columns) * 7 > (width - kNamesWidth) / map.columns.length;
// Besides the rows: turned names take their length, then come the axis's name and the scale.
export const heatMapHeight = (map, width) => map.rows.length * 34 + 124 +
  (areTurned(map, width) ? Math.min(longestName(map.columns) * 5, 80) : 0);
// Below, the map scrolls on its own.
export const heatMapWidth = (map) => map.columns.length * 34 + kNamesWidth;

const canShow = (map, value) => isNumber(value) && (!map.value.log || value > 0);
const onScale = (map, value) => (map.value.log ? Math.log10(value) : value);

function inkOn(colour) {
  const [red, green, blue] = colour.match(/[\d.]+/g).map(Number);
  return 0.299 * red + 0.587 * green + 0.114 * blue > 140 ? "#16191d" : "#ffffff";
}

function tileItem(map, theme) {
  return (params, api) => {
    const tile = map.tiles[params.dataIndex];
    const shown = canShow(map, tile.value);
    const [x, y] = api.coord([tile.column, tile.row]);
    const [width, height] = api.size([1, 1]);
    const fill = shown ? api.visual("color") : theme.empty;
    const text = tile.mark || (shown && width >= 44 ? numberText(tile.value, 3) : "");
    return {
      type: "rect",
      shape: {x: x - (width - kGap) / 2, y: y - (height - kGap) / 2, width: width - kGap, height: height - kGap, r: 3},
      style: {fill},
      emphasis: {style: {stroke: theme.ink, lineWidth: 2}},
      textContent: text ?
        {type: "text", style: {text, fontSize: 12, fill: shown ? inkOn(fill) : theme.quiet}} : undefined,
      textConfig: {position: "inside"},
    };
  };
}

function nameAxis(names, label, theme, width, isColumn, turned) {
  return {
    type: "category",
    data: names,
    name: label,
    nameLocation: "middle",
    nameGap: isColumn && !turned ? 28 : undefined,
    nameTextStyle: {color: theme.quiet, fontSize: 12},
    inverse: !isColumn,
    axisLabel: {color: theme.ink, fontSize: 12, interval: 0, rotate: turned ? 40 : 0, overflow: "truncate",
      width: turned ? 110 : isColumn ? undefined : Math.min(220, width * 0.3)},
    axisLine: {show: false},
    axisTick: {show: false},
    splitLine: {show: false},
  };
}

export function heatMapOption(map, width) {
  const theme = colours();
  const values = map.tiles.map(({value}) => value).filter((value) => canShow(map, value))
    .map((value) => onScale(map, value));
  const [min, max] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
  return {
    grid: {left: 8, right: 12, top: 8, bottom: 56, outerBoundsMode: "same", outerBoundsContain: "all"},
    xAxis: nameAxis(map.columns, map.column_label, theme, width, true, areTurned(map, width)),
    yAxis: nameAxis(map.rows, map.row_label, theme, width, false, false),
    visualMap: {
      type: "continuous",
      min,
      max: max > min ? max : min + 1,
      calculable: true,
      orient: "horizontal",
      left: "center",
      bottom: 4,
      itemWidth: 14,
      itemHeight: Math.min(260, width * 0.5),
      precision: 6,
      dimension: 2,
      inRange: {color: heat},
      outOfRange: {color: theme.empty},
      textStyle: {color: theme.quiet},
      formatter: (value) => numberText(map.value.log ? 10 ** value : value, 3),
    },
    series: [{
      type: "custom",
      renderItem: tileItem(map, theme),
      encode: {x: 0, y: 1},
      data: map.tiles.map(({column, row, value}) =>
        [column, row, canShow(map, value) ? onScale(map, value) : min]),
    }],
  };
}
