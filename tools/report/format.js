// Numbers as people read them.

const superscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const superscript = (exponent) => (exponent < 0 ? "⁻" : "") +
  [...String(Math.abs(exponent))].map((digit) => superscripts[digit]).join("");

// The document's numbers: null is none (NaN), "inf" and "-inf" are infinities.
export const isNumber = (value) => typeof value === "number";

// From `most` on, and below a thousandth, numbers are told by their powers of ten.
export function numberText(value, digits = 4, most = 1e9) {
  if (value === "inf") return "∞";
  if (value === "-inf") return "−∞";
  if (!isNumber(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= most)) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const factor = Number(mantissa) === 1 ? "" : `${String(Number(mantissa)).replace("-", "−")}·`;
    return `${factor}10${superscript(Number(exponent))}`;
  }
  const options = Number.isInteger(value) ? {maximumFractionDigits: 0} : {maximumSignificantDigits: digits};
  return value.toLocaleString("en", options).replace(/,/g, "\u202f").replace("-", "−");
}

export const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);

// There is little room at an axis.
export const tickText = (value) => numberText(value, 3, 1e6);

export const axisText = ({label, unit}) => (unit ? `${label} (${unit})` : label);

// A value with its spread.
export function spreadText({value, low, high}, unit) {
  const spread = isNumber(low) && isNumber(high) ? ` (${numberText(low)} to ${numberText(high)})` : "";
  return withUnit(numberText(value) + spread, unit);
}

// Seconds are told in the unit in which `longest` is a number of ordinary size.
export function timeScale(longest) {
  for (const [unit, perSecond] of [["s", 1], ["ms", 1e3], ["µs", 1e6]]) {
    if (longest * perSecond >= 1) return {unit, perSecond};
  }
  return {unit: "ns", perSecond: 1e9};
}
