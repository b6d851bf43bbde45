// What moves the infant: whoever looks at it, a recording, or physics.

import { choice } from "./elements.js";
import { ageSlider } from "./panel.js";
import { Physics } from "./physics.js";
import { Recording } from "./recording.js";

export function addModes(app, document) {
  const times = document.getElementById("times");
  const panel = document.getElementById("panel");
  const modes = {};
  if (app.data.recording) {
    const recording = new Recording(app, app.data.recording);
    panel.prepend(recording.panel);
    app.recording = recording;
    modes.recording = { row: recording.slider.row, enter: () => recording.show(recording.frame), leave: () => recording.slider.stop() };
  }
  const ages = ageSlider(app);
  modes.pose = {
    row: ages.row,
    enter: () => {
      app.touch?.setForces([], []);
      ages.set(app.age);
    },
    leave: () => ages.stop(),
  };
  if (app.data.physics) {
    app.physics = new Physics(app, app.data.physics, app.recording);
    modes.physics = app.physics;
  }
  const names = Object.keys(modes);
  const { row, press } = choice("What moves the infant", names, (name) => enter(name), LABELS);
  row.classList.add("modes");
  if (names.length > 1) times.append(row);
  times.append(...Object.values(modes).map((mode) => mode.row));

  function enter(name) {
    modes[app.mode]?.leave();
    app.mode = name;
    press(name);
    for (const [each, mode] of Object.entries(modes)) mode.row.hidden = each !== name;
    app.eyes.recorded = name === "recording" ? app.recording.videos : [];
    app.recording?.points?.hide(name !== "recording");
    app.showEyes(app.eyes.shown);
    modes[name].enter();
    app.look();
  }
  app.enter = enter;
  enter(names[0]);
}

const LABELS = { recording: "Recording", pose: "Explore", physics: "Physics" };
