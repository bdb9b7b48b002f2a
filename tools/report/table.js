import {element, inline} from "./dom.js";
import {isNumber, numberText} from "./format.js";

const collator = new Intl.Collator("en", {numeric: true, sensitivity: "base"});

// Numbers before texts, infinities where they belong.
function rank({number, text}) {
  if (number === "inf") return Infinity;
  if (number === "-inf") return -Infinity;
  return isNumber(number) ? number : text;
}

export function compareCells(a, b) {
  const [x, y] = [rank(a), rank(b)];
  if (isNumber(x) && isNumber(y)) return x === y ? 0 : x - y;
  if (isNumber(x) !== isNumber(y)) return isNumber(x) ? -1 : 1;
  return collator.compare(x, y);
}

function cellElement(cell, isNumeric) {
  // Some texts tell the spread themselves.
  const spread = isNumber(cell.low) && isNumber(cell.high) && !/ to /.test(cell.text) ?
    element("small", {class: "spread"}, `${numberText(cell.low)} to ${numberText(cell.high)}`) : undefined;
  return element("td", {class: isNumeric ? "number" : undefined}, ...inline(cell.text), spread);
}

// A table that sorts by the column whose head is pressed: up, then down, then as it was.
export function tableElement({title, columns, rows}) {
  const numeric = columns.map((_, column) => rows.some((row) => row[column]?.number !== undefined) &&
    rows.every((row) => !row[column]?.text || row[column].number !== undefined || row[column].text.length < 3));
  const body = element("tbody");
  const heads = columns.map((name, column) => {
    const button = element("button", {type: "button"}, ...inline(name));
    const head = element("th", {scope: "col", class: numeric[column] ? "number" : undefined}, button);
    button.addEventListener("click", () => sort(column));
    return head;
  });

  function fill(order) {
    body.replaceChildren(...order.map((row) =>
      element("tr", {}, ...row.map((cell, column) => cellElement(cell, numeric[column])))));
  }
  function sort(column) {
    const before = heads[column].getAttribute("aria-sort");
    const now = before === "ascending" ? "descending" : before === "descending" ? null : "ascending";
    for (const head of heads) head.removeAttribute("aria-sort");
    if (now) heads[column].setAttribute("aria-sort", now);
    const direction = now === "descending" ? -1 : 1;
    const none = {text: ""};
    fill(now ? [...rows].sort((a, b) => direction * compareCells(a[column] ?? none, b[column] ?? none)) : rows);
  }

  fill(rows);
  const table = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body);
  // Wider than a phone: scrolls on its own, with the keyboard as well.
  return element("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": title}, table);
}
