// Replaying a recorded episode: motion, touch, what the eyes saw, and any number that was recorded as a curve.

import { drawing, element, section, sentence, timeline } from "./elements.js";
import { Points } from "./points.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [290, 90, 34, 14];
const STRONG = 0.98; // Share of forces that are less than what is shown in the last colour.

export class Recording {
  constructor(app, recording) {
    Object.assign(this, { app, recording, frame: 0 });
    this.seconds = recording.seconds.values;
    this.width = recording.qpos.shape[1];
    const forces = recording.felt ? Float32Array.from(recording.felt.forces_n.values).sort() : [];
    this.most = forces[Math.floor(STRONG * forces.length)] || 1;
    this.videos = this.#videos();
    this.points = recording.points && new Points(app, recording.points);
    this.curves = [new Curve(this, "touch"), new Curve(this, "proprioception")];
    const last = this.seconds.at(-1);
    this.slider = timeline({
      label: "Time in seconds",
      low: 0, high: last, step: this.seconds[1] ?? 1, value: 0,
      ticks: [0, 0.25, 0.5, 0.75, 1].map((share) => `${(share * last).toFixed(last < 20 ? 1 : 0)} s`),
      write: (time) => `${time.toFixed(2)} s`,
      changed: (time) => this.seek(time),
      seconds: () => last,
      playing: ["Play", "Pause"],
    });
    this.slider.slider.id = "time";
  }

  get panel() {
    const { episode, infant } = this.recording;
    const text = `${infant === null ? "" : `Infant ${infant}, `}episode ${episode}: ${this.seconds.at(-1).toFixed(1)} s.`;
    const found = section("Recording", element("p", { className: "note", textContent: text.replace(/^e/, "E") }), ...(this.points ? [this.points.control] : []), ...this.curves.map(({ figure }) => figure));
    found.id = "recording";
    return found;
  }

  #videos() {
    return Object.entries(this.recording.pictures).map(([name, { values }]) => {
      const video = element("video", { muted: true, playsInline: true, preload: "auto", "aria-label": sentence(name) });
      video.src = URL.createObjectURL(new Blob([values], { type: "video/mp4" }));
      return { name, video };
    });
  }

  // The command of an actuator in a control step; after the last one, that of the last.
  action(actuator, control) {
    const curve = this.recording.curves.find(({ name }) => name === "action");
    const frame = Math.min(Math.floor((control + 1) / this.recording.stride), this.seconds.length - 1);
    return valueOf(curve, actuator, frame);
  }

  // Show the frame at a time.
  seek(time) {
    let frame = 0;
    let end = this.seconds.length;
    while (end - frame > 1) {
      const middle = (frame + end) >> 1;
      if (this.seconds[middle] <= time + 1e-6) frame = middle;
      else end = middle;
    }
    this.show(frame);
  }

  show(frame) {
    this.frame = frame;
    const { app, recording, width } = this;
    const age = recording.frame_ages_months.values[frame];
    if (Math.abs(age - app.age) > 1e-6) app.setAge(age);
    if (recording.around) {
      const size = recording.around.values.length / this.seconds.length;
      app.surroundings.place(recording.around.values.subarray(frame * size, (frame + 1) * size));
    }
    if (recording.expressions) {
      const name = recording.expressions.names[recording.expressions.shown.values[frame]];
      if (name !== app.infant.expression) app.setExpression(name);
    }
    if (recording.felt && app.touch) {
      const [first, end] = recording.felt.ends.values.subarray(frame, frame + 2);
      app.touch.setForces(recording.felt.points.values.subarray(first, end), recording.felt.forces_n.values.subarray(first, end), this.most);
    }
    for (const { video } of this.videos) video.currentTime = (frame * recording.stride + 0.5) * recording.picture_s;
    this.points?.show(this.seconds[frame]);
    for (const curve of this.curves) curve.show(frame);
    app.show(recording.qpos.values.slice(frame * width, (frame + 1) * width));
  }
}

// A curve of one of the recorded numbers, which can be chosen, with a line at the present time.
class Curve {
  constructor(recording, name) {
    this.recording = recording;
    const { curves } = recording.recording;
    this.what = element("select", { "aria-label": "What is shown" }, ...curves.map((each) => element("option", { value: each.name, textContent: sentence(each.name) })));
    this.what.value = (curves.find((each) => each.name === name) ?? curves[0]).name;
    this.which = element("select", { "aria-label": "Which of its numbers" });
    this.value = element("span");
    this.svg = drawing("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": "The chosen number by time" });
    this.svg.addEventListener("click", (event) => {
      const box = this.svg.getBoundingClientRect();
      const share = (((event.clientX - box.left) / box.width) * WIDTH - LEFT) / (WIDTH - LEFT - 4);
      recording.slider.stop();
      recording.slider.set(Math.min(Math.max(share, 0), 1) * recording.seconds.at(-1));
    });
    this.what.addEventListener("change", () => this.#choose());
    this.which.addEventListener("change", () => this.#draw());
    this.figure = element("figure", { className: "curve" }, element("div", { className: "row" }, this.what, this.which), this.value, this.svg);
    this.#choose();
  }

  #choose() {
    this.curve = this.recording.recording.curves.find((each) => each.name === this.what.value);
    this.which.replaceChildren(...this.curve.layout.map((name, i) => element("option", { value: i, textContent: name.replace("robot:", "") })));
    this.#draw();
  }

  at(frame) {
    return valueOf(this.curve, Number(this.which.value), frame);
  }

  #draw() {
    const channel = Number(this.which.value);
    let [low, high] = [this.curve.low.values[channel], this.curve.high.values[channel]];
    if (high - low < 1e-9) [low, high] = [low - 1, high + 1];
    const { seconds } = this.recording;
    const last = seconds.at(-1) || 1;
    this.x = (time) => LEFT + (time / last) * (WIDTH - LEFT - 4);
    const y = (value) => HEIGHT - BOTTOM - ((value - low) / (high - low)) * (HEIGHT - BOTTOM - 6);
    let path = "";
    for (let frame = 0; frame < seconds.length; frame += 1) path += `${frame ? "L" : "M"}${this.x(seconds[frame]).toFixed(1)} ${y(this.at(frame)).toFixed(1)}`;
    const label = (value) => drawing("text", { x: LEFT - 4, y: y(value) + 3, "text-anchor": "end" }, short(value));
    this.line = drawing("line", { class: "now", y1: 2, y2: HEIGHT - BOTTOM });
    this.svg.replaceChildren(drawing("line", { class: "grid", x1: LEFT, x2: WIDTH - 4, y1: HEIGHT - BOTTOM, y2: HEIGHT - BOTTOM }), label(low), label(high), drawing("path", { class: "own thin", d: path }), this.line);
    this.show(this.recording.frame ?? 0);
  }

  show(frame) {
    const x = this.x(this.recording.seconds[frame]);
    this.line.setAttribute("x1", x);
    this.line.setAttribute("x2", x);
    const unit = this.curve.layout[Number(this.which.value)].match(/\[(.*)\]$/)?.[1] ?? "";
    this.value.textContent = `${short(this.at(frame))} ${unit}`;
  }
}

// A number of a curve in a frame, from its level between the least and the largest.
function valueOf({ low, high, levels }, channel, frame) {
  const share = (levels.values[channel * levels.shape[1] + frame] + 32768) / 65535;
  return low.values[channel] + share * (high.values[channel] - low.values[channel]);
}

function short(value) {
  const size = Math.abs(value);
  const text = size >= 100 ? value.toFixed(0) : size >= 1 ? value.toFixed(1) : size >= 0.001 || size === 0 ? value.toFixed(size === 0 ? 0 : 3) : value.toExponential(0);
  return text.replace("-", "\u2212");
}
