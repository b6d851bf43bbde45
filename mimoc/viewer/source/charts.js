// WHO's growth curves with the child's own, and a dot that moves along it with age.

import { Ages } from "./ages.js";
import { drawing, element } from "./elements.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [290, 104, 26, 16];
const WHO = { male: "boys", female: "girls", mean: "the mean of boys and girls" };

export class Charts {
  constructor({ standards, ages_months }) {
    this.ages = new Ages(ages_months);
    const charts = Object.entries(standards.charts).map(([name, chart]) => this.#chart(name, chart));
    const share = (i) => standards.percentiles[i];
    const text = standards.percentiles
      ? `Shaded: the middle ${share(4) - share(0)} % and ${share(3) - share(1)} % of healthy children; WHO, ${WHO[standards.reference]}.`
      : "Scale not known: of the average child's size, and compared with no standard.";
    this.figures = [...charts.map(({ figure }) => figure), element("p", { className: "note", textContent: text })];
    this.charts = charts;
  }

  // Draw a plot (Plot.to_data in mimoc/render/plots/plot.py): bands and lines, whose last one is the child's.
  #chart(name, { plot, percentile }) {
    const { label, unit } = plot.y;
    const child = plot.lines.at(-1).y;
    const all = [...plot.bands.flatMap(({ low, high }) => [...low.values, ...high.values]), ...child.values];
    const [low, high] = [Math.floor(Math.min(...all)), Math.ceil(Math.max(...all))];
    const x = (month) => LEFT + (month / 24) * (WIDTH - LEFT - 6);
    const y = (value) => HEIGHT - BOTTOM - ((value - low) / (high - low)) * (HEIGHT - BOTTOM - 6);
    const points = (xs, ys) => Array.from(xs.values, (month, i) => `${x(month).toFixed(1)} ${y(ys.values[i]).toFixed(1)}`);
    const through = (look, points, end = "") => drawing("path", { class: look, d: `M${points.join("L")}${end}` });
    const bands = plot.bands.map((band) => through(band.look, [...points(band.x, band.low), ...points(band.x, band.high).reverse()], "Z"));
    const curves = plot.lines.map((line) => through(line.look, points(line.x, line.y)));
    const dot = drawing("circle", { class: "dot", r: 5 });
    const lines = [0, 6, 12, 18, 24].flatMap((month) => [
      drawing("line", { class: "grid", x1: x(month), x2: x(month), y1: 4, y2: HEIGHT - BOTTOM }),
      drawing("text", { x: x(month), y: HEIGHT - 4, "text-anchor": "middle" }, String(month)),
    ]);
    const heights = steps(low, high).map((value) => drawing("text", { x: LEFT - 5, y: y(value) + 3.5, "text-anchor": "end" }, String(value)));
    const svg = drawing(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${label} by age in months` },
      ...[...bands, ...lines, ...heights, ...curves, dot],
    );
    const told = element("span");
    const figure = element("figure", {}, element("figcaption", {}, element("b", { textContent: label }), told), svg);
    const setAge = (age) => {
      const [value] = this.ages.blend(child, age);
      const rank = percentile ? `${ordinal(this.ages.blend(percentile, age)[0])} percentile` : "scale not known";
      told.textContent = `${value.toFixed(1)} ${unit} · ${rank}`;
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
