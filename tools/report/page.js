// Builds the page from the report in it. Texts of a report are texts here, whatever they hold.

import {element, inline, paragraphs} from "./dom.js";
import {heatMapFigure, lineChartFigure, redrawAll, timelineFigure} from "./figures.js";
import {numberText} from "./format.js";
import {tableElement} from "./table.js";
import {isDark, onThemeChange, toggleTheme} from "./theme.js";

const source = document.getElementById("report-json").textContent;
const report = JSON.parse(source);
const starts = [];

function save() {
  const link = element("a", {download: `study-${report.study}.json`,
    href: URL.createObjectURL(new Blob([source], {type: "application/json"}))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function themeButton() {
  const button = element("button", {type: "button", id: "theme"});
  const name = () => button.replaceChildren(isDark() ? "Light" : "Dark");
  button.addEventListener("click", () => {
    toggleTheme();
    name();
    redrawAll();
  });
  onThemeChange(name);
  name();
  return button;
}

function button(id, text, action) {
  const made = element("button", {type: "button", id}, text);
  made.addEventListener("click", action);
  return made;
}

// Where the figures come from.
function facts() {
  const {build, machine} = report;
  const memory = machine.memory_bytes ? `${numberText(machine.memory_bytes / 2 ** 30, 3)} GiB` : "";
  const list = [
    ["Machine", [machine.cpu, machine.cores && `${machine.cores} cores`, memory].filter(Boolean).join(", ")],
    ["System", machine.system],
    ["Program", [`sweepgrid ${build.version}`, build.commit && `commit ${build.commit}`].filter(Boolean).join(", ")],
    ["Compiler", [build.compiler, build.build_type, build.flags].filter(Boolean).join(", ")],
    ["Written", report.date.replace("T", " ").replace("Z", " UTC")],
  ];
  if (report.command) list.push(["Made by", element("code", {}, report.command)]);
  const items = list.filter(([, fact]) => fact).map(([name, fact]) =>
    element("div", {}, element("dt", {}, name), element("dd", {}, fact)));
  return element("dl", {class: "facts"}, ...items);
}

function tableFigure(table) {
  const whole = element("figure", {id: table.id, class: "table wide"},
    element("h3", {}, element("a", {href: `#${table.id}`}, ...inline(table.title))), tableElement(table),
    element("figcaption", {}, ...inline(table.caption)));
  return {element: whole, start: () => {}};
}

const figuresOf = (section) => [...section.charts.map(lineChartFigure), ...section.maps.map(heatMapFigure),
  ...section.timelines.map(timelineFigure), ...section.tables.map(tableFigure)];

const itemsOf = (section) => [...section.charts, ...section.maps, ...section.timelines, ...section.tables];

// One figure that is called as its section is.
const isAlone = (section) => itemsOf(section).length === 1 && itemsOf(section)[0].title === section.title;

function sectionElement(section, index) {
  const figures = figuresOf(section);
  starts.push(...figures.map(({start}) => start));
  // A title told twice is for those who hear the page only.
  if (isAlone(section)) figures[0].element.querySelector("h3").classList.add("heard");
  return element("section", {id: `section-${index + 1}`}, element("h2", {}, ...inline(section.title)),
    ...paragraphs(section.text), element("div", {class: "figures"}, ...figures.map((one) => one.element)));
}

function contents() {
  const entry = (id, title) => element("a", {href: `#${id}`}, ...inline(title));
  const list = report.sections.map((section, index) => {
    const items = isAlone(section) ? [] : itemsOf(section);
    return element("li", {}, entry(`section-${index + 1}`, section.title),
      element("ul", {}, ...items.map(({id, title}) => element("li", {}, entry(id, title)))));
  });
  return element("nav", {"aria-label": "Contents"}, element("h2", {}, "Contents"), element("ol", {}, ...list));
}

const head = element("header", {}, element("p", {class: "kind"}, "sweepgrid study"),
  element("h1", {}, ...inline(report.title)), element("div", {class: "summary"}, ...paragraphs(report.summary)),
  facts(),
  element("div", {class: "tools"}, button("save", "Save JSON", save), button("print", "Print", () => print()),
    themeButton()));
document.getElementById("report").append(head, contents(), ...report.sections.map(sectionElement));
// Charts take the width that they find.
for (const start of starts) start();
// The address may ask for a part that was not there when the page was opened.
if (location.hash) document.getElementById(decodeURIComponent(location.hash.slice(1)))?.scrollIntoView();
