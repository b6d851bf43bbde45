// The controls of the page.

import { ageText } from "./app.js";
import { check, choice, element, section, sentence, timeline } from "./elements.js";
import { JointSliders } from "./joints.js";

const GROWING_SECONDS = 12; // From birth to 24 months.

export function fillPanel(app, document) {
  const panel = document.getElementById("panel");
  panel.append(section("Growth", ...app.charts.figures));
  panel.append(poses(app), shown(app), joints(app));
  const about = document.getElementById("about");
  const licences = element("button", { type: "button", className: "link", textContent: "Licences" });
  licences.addEventListener("click", () => about.showModal());
  panel.append(element("p", { className: "footer" }, `Made by mimoc ${app.data.version}`, licences));
}

export function ageSlider(app) {
  const slider = timeline({
    label: "Age in months",
    low: 0, high: 24, step: 0.5, value: app.age,
    ticks: ["birth", "3", "6", "9", "12", "15", "18", "21", "24 mo"],
    write: ageText,
    changed: (age) => app.setAge(age),
    seconds: () => GROWING_SECONDS,
    playing: ["Grow", "Pause"],
  });
  slider.slider.id = "age";
  return slider;
}

function poses(app) {
  const { row, press } = choice("Pose", app.body.poses, (pose) => {
    app.setPose(pose);
    press(pose);
  });
  press(app.pose);
  const found = section("Pose", row);
  found.id = "poses";
  app.changed.push(() => press(app.mode === "pose" && !app.own.size ? app.pose : null));
  return found;
}

function shown(app) {
  const controls = [];
  if (app.infant.skin) controls.push(check("Skin and clothes", app.infant.skinned, (on) => (app.infant.showSkin(on), app.stage.drawMoved())));
  if (app.touch) controls.push(check("Touch points", false, (on) => app.showTouch(on)));
  if (app.data.eyes.names.length) controls.push(check("What the eyes see", false, (on) => app.showEyes(on)));
  if (!app.surroundings.isEmpty) controls.push(check("Surroundings", true, (on) => ((app.surroundings.scene.visible = on), app.stage.drawMoved())));
  const names = Object.keys(app.infant.expressions);
  if (names.length) {
    const select = element("select", {}, ...names.map((name) => element("option", { value: name, textContent: sentence(name) })));
    select.value = app.infant.expression;
    app.changed.push(() => (select.value = app.infant.expression));
    select.addEventListener("change", () => app.setExpression(select.value));
    controls.push(element("label", { className: "check" }, "Expression", select));
  }
  return section("Show", ...controls);
}

function joints(app) {
  const show = () => sliders.show(app.mode !== "pose");
  const sliders = new JointSliders(app.body, app.data.groups, { changed: (joint, angle) => app.setJoint(joint, angle), opened: show });
  app.changed.push(show);
  const note = element("p", { className: "note", textContent: "Limits are those of the age shown." });
  const found = section("Joints", note, ...sliders.groups);
  found.id = "joints";
  return found;
}
