// WHO's growth curves with the child's own, and a dot that moves along it with age.

import { Ages } from "./ages.js";
import { drawing, element } from "./elements.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [290, 104, 26, 16];
const LABELS = { length_cm: ["Length", "cm"], weight_kg: ["Weight", "kg"], head_circumference_cm: ["Head", "cm"] };
const WHO = { male: "boys", female: "girls", mean: "the mean of boys and girls" };

export class Charts {
  constructor({ standards, ages_months }) {
    this.ages = new Ages(ages_months);
    const charts = Object.entries(standards.measures).map(([name, measure]) => this.#chart(name, measure, standards));
    const share = (i) => standards.percentiles[i];
    const text = `Shaded: the middle ${share(4) - share(0)} % and ${share(3) - share(1)} % of healthy children; WHO, ${WHO[standards.reference]}.`;
    this.figures = [...charts.map(({ figure }) => figure), element("p", { className: "note", textContent: text })];
    this.charts = charts;
  }

  #chart(name, { curves, child, percentile }, standards) {
    const [label, unit] = LABELS[name];
    const months = standards.ages_months;
    const [rows, columns] = curves.shape;
    const curve = (column) => Array.from({ length: rows }, (_, row) => [months[row], curves.values[row * columns + column]]);
    const all = [...curves.values, ...child.values];
    const [low, high] = [Math.floor(Math.min(...all)), Math.ceil(Math.max(...all))];
    const x = (month) => LEFT + (month / 24) * (WIDTH - LEFT - 6);
    const y = (value) => HEIGHT - BOTTOM - ((value - low) / (high - low)) * (HEIGHT - BOTTOM - 6);
    const path = (points) => points.map(([month, value], i) => `${i ? "L" : "M"}${x(month).toFixed(1)} ${y(value).toFixed(1)}`).join("");
    const band = (one, other) => `${path(curve(one))}${path(curve(other).reverse()).replace("M", "L")}Z`;
    const own = this.ages.months.map((month, i) => [month, child.values[i]]);
    const dot = drawing("circle", { class: "dot", r: 5 });
    const lines = [0, 6, 12, 18, 24].flatMap((month) => [
      drawing("line", { class: "grid", x1: x(month), x2: x(month), y1: 4, y2: HEIGHT - BOTTOM }),
      drawing("text", { x: x(month), y: HEIGHT - 4, "text-anchor": "middle" }, String(month)),
    ]);
    const heights = steps(low, high).map((value) => drawing("text", { x: LEFT - 5, y: y(value) + 3.5, "text-anchor": "end" }, String(value)));
    const svg = drawing(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${label} by age in months` },
      ...[drawing("path", { class: "wide", d: band(0, 4) }), drawing("path", { class: "narrow", d: band(1, 3) }), ...lines, ...heights],
      ...[drawing("path", { class: "median", d: path(curve(2)) }), drawing("path", { class: "own", d: path(own) }), dot],
    );
    const told = element("span");
    const figure = element("figure", {}, element("figcaption", {}, element("b", { textContent: label }), told), svg);
    const setAge = (age) => {
      const [value] = this.ages.blend(child, age);
      const [share] = this.ages.blend(percentile, age);
      told.textContent = `${value.toFixed(1)} ${unit} · ${ordinal(share)} percentile`;
      dot.setAttribute("cx", x(age));
      dot.setAttribute("cy", y(value));
      return value;
    };
    return { name, figure, setAge };
  }

  // Move the dots; returns what the child measures, by name.
  setAge(age) {
    return Object.fromEntries(this.charts.map(({ name, setAge }) => [name, setAge(age)]));
  }
}

// Three or four round numbers between two.
function steps(low, high) {
  const step = [1, 2, 5, 10, 20].find((each) => (high - low) / each <= 4) ?? 50;
  const first = Math.ceil(low / step) * step;
  return Array.from({ length: Math.floor((high - first) / step) + 1 }, (_, i) => first + i * step);
}

function ordinal(share) {
  const number = Math.min(Math.max(Math.round(share), 1), 99);
  const ending = number % 100 > 10 && number % 100 < 14 ? "th" : (["th", "st", "nd", "rd"][number % 10] ?? "th");
  return `${number}${ending}`;
}
