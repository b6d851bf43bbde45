// Small parts of the page.

export function element(tag, properties = {}, ...children) {
  const found = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("aria-") || name === "for") found.setAttribute(name, value);
    else found[name] = value;
  }
  found.append(...children);
  return found;
}

const SVG = "http://www.w3.org/2000/svg";

export function drawing(tag, attributes = {}, ...children) {
  const found = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) found.setAttribute(name, value);
  found.append(...children);
  return found;
}

export function section(title, ...children) {
  return element("section", { "aria-label": title }, element("h2", { textContent: title }), ...children);
}

export function check(label, checked, changed) {
  const box = element("input", { type: "checkbox", checked });
  box.addEventListener("change", () => changed(box.checked));
  return element("label", { className: "check" }, box, label);
}

// Buttons of which one is pressed; returns the row and a function that presses one, or none.
export function choice(label, names, chosen, words = {}) {
  const buttons = names.map((name) => element("button", { type: "button", textContent: words[name] ?? sentence(name), "aria-pressed": "false" }));
  const press = (name) => buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(names[i] === name)));
  buttons.forEach((button, i) => button.addEventListener("click", () => chosen(names[i])));
  const row = element("div", { className: "row" }, ...buttons);
  row.setAttribute("role", "group");
  row.setAttribute("aria-label", label);
  return { row, press };
}

// A slider with a button that moves it on by itself.
export function timeline({ label, low, high, step, value, ticks, write, changed, seconds, playing }) {
  const slider = element("input", { type: "range", min: low, max: high, step, value, "aria-label": label });
  const output = element("output");
  const play = element("button", { type: "button", className: "play" });
  const marks = element("div", { className: "ticks", "aria-hidden": "true" }, ...ticks.map((text) => element("span", { textContent: text })));
  let last = null;
  const told = () => {
    output.textContent = write(Number(slider.value));
    slider.setAttribute("aria-valuetext", output.textContent);
  };
  const run = (now) => {
    if (last === null) return;
    const next = Number(slider.value) + ((now - last) / 1000) * ((high - low) / seconds());
    last = now;
    set(Math.min(next, high));
    if (next >= high) stop();
    else requestAnimationFrame(run);
  };
  const stop = () => {
    last = null;
    [play.textContent, play.title] = ["▶\uFE0E", playing[0]];
    play.setAttribute("aria-label", playing[0]);
  };
  const start = () => {
    if (Number(slider.value) >= high) slider.value = low;
    last = performance.now();
    [play.textContent, play.title] = ["❚❚", playing[1]];
    play.setAttribute("aria-label", playing[1]);
    requestAnimationFrame(run);
  };
  const set = (to) => {
    slider.step = "any";
    slider.value = to;
    told();
    changed(Number(slider.value));
  };
  play.addEventListener("click", () => (last === null ? start() : stop()));
  slider.addEventListener("pointerdown", stop);
  slider.addEventListener("keydown", () => (slider.step = step));
  slider.addEventListener("input", () => {
    stop();
    told();
    changed(Number(slider.value));
  });
  stop();
  told();
  const track = element("div", { className: "track" }, slider, marks);
  return { row: element("div", { className: "time" }, play, track, output), set, stop, start, slider };
}

// "left_arm" as words: "Left arm".
export function sentence(name) {
  const words = name.replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}
