// Sliders of all joints, by group.

import { ROOT } from "./body.js";
import { element, sentence } from "./elements.js";

const WORDS = {
  hip_lean: "Lean to the side", hip_rot: "Turn", hip_bend: "Bend forwards",
  shoulder_horizontal: "Shoulder: across", shoulder_ad_ab: "Shoulder: sideways", shoulder_rotation: "Shoulder: turn",
  elbow: "Elbow", hand1: "Wrist: turn", hand2: "Wrist: bend", hand3: "Wrist: sideways", fingers: "Fingers",
  head_swivel: "Turn", head_tilt: "Nod", head_tilt_side: "Tilt to the side",
  hip1: "Hip: bend", hip2: "Hip: sideways", hip3: "Hip: turn", knee: "Knee",
  foot1: "Ankle: bend", foot2: "Ankle: sideways", foot3: "Ankle: turn", toes: "Toes",
};
const ORDER = ["neck", "eyes", "trunk", "right_arm", "left_arm", "right_hand", "left_hand", "right_leg", "left_leg"];
const DEGREE = 180 / Math.PI;

export class JointSliders {
  constructor(body, groups, { changed, opened }) {
    this.body = body;
    this.rows = [];
    const inOrder = Object.keys(groups).sort((one, other) => placeOf(one) - placeOf(other));
    this.groups = inOrder.map((group) => {
      const joints = groups[group].map((name) => body.jointNames.indexOf(name)).filter((joint) => joint >= 0);
      const rows = joints.map((joint) => this.#row(group, joint, changed));
      this.rows.push(...rows);
      const found = element("details", {}, element("summary", { textContent: sentence(group) }), ...rows.map(({ row }) => row));
      found.addEventListener("toggle", () => opened());
      return found;
    });
  }

  #row(group, joint, changed) {
    const name = wordsOf(this.body.jointNames[joint], group);
    const slider = element("input", { type: "range", step: 1, "aria-label": `${sentence(group)}: ${name}` });
    const output = element("output");
    slider.addEventListener("input", () => changed(joint, Number(slider.value) / DEGREE));
    return { joint, slider, output, row: element("div", { className: "joint" }, element("span", { textContent: name }), output, slider) };
  }

  // Show the present angles and limits.
  show(disabled) {
    for (const { joint, slider, output } of this.rows) {
      if (!slider.closest("details").open) continue;
      const [low, high] = this.body.limits(joint).map((angle) => Math.round(angle * DEGREE));
      const angle = Math.round(this.body.qpos[ROOT + joint] * DEGREE);
      [slider.min, slider.max, slider.value] = [low, high, angle];
      output.textContent = `${angle}°`.replace("-", "\u2212");
      slider.disabled = disabled;
      slider.setAttribute("aria-valuetext", `${angle} degrees`);
    }
  }
}

const placeOf = (group) => (ORDER.includes(group) ? ORDER.indexOf(group) : ORDER.length);

function wordsOf(joint, group) {
  const [, side] = group.match(/^(left|right)_/) ?? [];
  const bare = joint.replace(/^robot:/, "");
  const name = side ? bare.replace(`${side}_`, "") : bare;
  const [, stem, level] = name.match(/^(hip_(?:lean|rot|bend))(\d)$/) ?? [];
  if (stem) return `${WORDS[stem]}, ${level === "1" ? "below" : "above"}`;
  return WORDS[name] ?? sentence(name);
}
