// The points of a filmed infant beside it, as stick figures: those that were recorded, and where its own are.

import { check, drawing, element } from "./elements.js";

const JOINT = 0.009; // Radius of a point, as a share of the picture's width.

export class Points {
  constructor(app, points) {
    this.points = points;
    const [left, top, width, height] = points.box.values;
    this.figures = ["recorded", "fitted"].map((name) => new Figure(name, points, JOINT * width));
    const svg = drawing("svg", { viewBox: `${left} ${top} ${width} ${height}`, role: "img", "aria-label": "Points of the infant, recorded and fitted" });
    svg.append(...this.figures.map(({ group }) => group));
    this.error = element("span");
    const names = element("span", {}, element("b", { className: "recorded", textContent: "Recorded" }), " and ", element("b", { className: "fitted", textContent: "fitted" }));
    this.place = element("figure", { id: "points" }, svg, element("figcaption", {}, names, this.error));
    app.page.getElementById("stage").append(this.place);
    this.wanted = true;
  }

  get control() {
    return check("Recorded points", true, (on) => {
      this.wanted = on;
      this.hide(false);
    });
  }

  hide(hidden) {
    this.place.hidden = hidden || !this.wanted;
  }

  show(seconds) {
    const { recorded, errors, rate_hz: rate } = this.points;
    const frame = Math.min(Math.round(seconds * rate), recorded.shape[0] - 1);
    this.frame = frame;
    for (const figure of this.figures) figure.show(frame);
    const error = errors.values[frame];
    this.error.textContent = Number.isNaN(error) ? "" : `${(100 * error).toFixed(1)} % of the trunk apart`;
  }
}

class Figure {
  constructor(name, points, radius) {
    this.places = points[name];
    this.bones = Array.from({ length: points.bones.shape[0] }, (_, i) => Array.from(points.bones.values.subarray(2 * i, 2 * i + 2)));
    this.lines = this.bones.map(() => drawing("line"));
    this.dots = Array.from({ length: this.places.shape[1] }, () => drawing("circle", { r: radius }));
    this.group = drawing("g", { class: name }, ...this.lines, ...this.dots);
  }

  show(frame) {
    const [, count, size] = this.places.shape;
    const places = Array.from({ length: count }, (_, i) => this.places.values.subarray((frame * count + i) * size, (frame * count + i + 1) * size));
    const seen = places.map((place) => place.every((number) => !Number.isNaN(number)));
    this.lines.forEach((line, i) => {
      const [first, second] = this.bones[i];
      set(line, seen[first] && seen[second], { x1: places[first][0], y1: places[first][1], x2: places[second][0], y2: places[second][1] });
    });
    this.dots.forEach((dot, i) => set(dot, seen[i], { cx: places[i][0], cy: places[i][1] }));
  }
}

function set(shape, visible, attributes) {
  shape.style.display = visible ? "" : "none";
  if (visible) for (const [name, value] of Object.entries(attributes)) shape.setAttribute(name, value);
}
