// Colours of the charts; those of the page are in page.css. The first eight of either list can be told apart with any
// kind of colour vision (after Okabe and Ito), and marks differ in shape as well.

const light = {
  ink: "#1d2430",
  quiet: "#5b6472",
  line: "#c9ced6",
  faint: "#e8ebef",
  paper: "#ffffff",
  empty: "#eceef1",
  series: ["#0072b2", "#d55e00", "#009073", "#b4599a", "#b07c00", "#3f9fd6", "#5b5b5b", "#7a6ad8"],
};
const dark = {
  ink: "#e7eaee",
  quiet: "#a3acb8",
  line: "#4a5361",
  faint: "#2b323c",
  paper: "#181d24",
  empty: "#262d36",
  series: ["#56b4e9", "#ff8c42", "#2fc79b", "#e29bcb", "#f0b73e", "#7fa8ff", "#bdbdbd", "#b6a8ff"],
};

// Viridis: even steps in lightness, for any kind of colour vision.
export const heat = ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6dcd59", "#b4de2c",
  "#fde725"];

export const symbols = ["circle", "rect", "triangle", "diamond", "path://M4,0H6V4H10V6H6V10H4V6H0V4H4Z"];
// The same within a box of 10 x 10, for legends.
const symbolPaths = ["M5,0A5,5 0 1 1 5,10A5,5 0 1 1 5,0Z", "M0,0H10V10H0Z", "M5,0L10,10H0Z", "M5,0L10,5L5,10L0,5Z",
  "M4,0H6V4H10V6H6V10H4V6H0V4H4Z"];

const preference = matchMedia("(prefers-color-scheme: dark)");
const printing = matchMedia("print");
const root = document.documentElement;

export const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : preference.matches);
export const colours = () => (isDark() && !isPrinting() ? dark : light);

let printAsked = false;
export const isPrinting = () => printAsked || printing.matches;

const parts = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

// From the ninth on, the same colours come again, half as strong.
export function seriesColour(index) {
  const {series, paper} = colours();
  const colour = series[index % series.length];
  if (index < series.length) return colour;
  const [own, behind] = [parts(colour), parts(paper)];
  return `rgb(${own.map((part, at) => Math.round((part + behind[at]) / 2)).join(",")})`;
}

// Calls `redraw` whenever what the two above return has changed.
export function onThemeChange(redraw) {
  preference.addEventListener("change", redraw);
  printing.addEventListener("change", redraw);
  for (const [event, value] of [["beforeprint", true], ["afterprint", false]]) {
    addEventListener(event, () => {
      printAsked = value;
      redraw();
    });
  }
}

export function toggleTheme() {
  root.dataset.theme = isDark() ? "light" : "dark";
}

// A piece of a series for legends and tooltips: its line and mark.
export function swatch({colour, dash, symbol, hollow, box}) {
  const holder = document.createElement("span");
  holder.className = "swatch";
  const line = dash === undefined ? "" :
    `<line x1="0" y1="7" x2="26" y2="7" stroke="${colour}" stroke-width="2" stroke-dasharray="${dash}"/>`;
  const mark = symbol === undefined ? "" :
    `<path d="${symbolPaths[symbol]}" transform="translate(8.5,2.5) scale(.9)" stroke="${colour}" stroke-width="2" ` +
    `fill="${hollow ? colours().paper : colour}"/>`;
  const square = box ? `<rect x="7" y="1" width="12" height="12" rx="2" fill="${colour}"/>` : "";
  holder.innerHTML = `<svg width="26" height="14" aria-hidden="true">${line}${mark}${square}</svg>`;
  return holder;
}
