// Physics: MuJoCo itself moves the infant, which falls, is pulled, and acts at random or as it was recorded.

import { Vector3 } from "three";
import { bytesOf, unzip } from "./data.js";
import { choice, element } from "./elements.js";

const DROP = 0.12; // Metres above where it was, so that it falls.
const STIFFNESS = 25; // Of the spring that pulls, by the weight of what is pulled.
const BEHIND = 0.05; // Seconds that physics may fall behind at most, rather than catch up.
const WORDS = { limp: "Limp", random: "Random", recorded: "Recorded" };

export class Physics {
  constructor(app, described, recording) {
    Object.assign(this, { app, described, recording, action: "limp", speed: 1, running: false });
    const names = recording ? Object.keys(WORDS) : ["limp", "random"];
    const actions = choice("What it does", names, (name) => {
      this.action = name;
      this.steps = 0;
      actions.press(name);
    }, WORDS);
    actions.press(this.action);
    const again = element("button", { type: "button", textContent: "Drop again" });
    again.addEventListener("click", () => this.drop());
    this.told = element("output");
    this.play = element("button", { type: "button", className: "play" });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.run()));
    this.row = element("div", { className: "time wrap" }, this.play, actions.row, again, this.told);
    this.#label();
  }

  #label() {
    const label = this.running ? "Pause" : "Run";
    this.play.textContent = this.running ? "❚❚" : "▶\uFE0E";
    this.play.title = label;
    this.play.setAttribute("aria-label", label);
  }

  // Start from where the infant is, a little higher; MuJoCo is loaded when it is first needed.
  async enter() {
    try {
      this.app.tell(this.mujoco ? "" : "Loading MuJoCo …");
      this.mujoco ??= await loadEngine(document);
      this.app.tell("");
    } catch (error) {
      this.app.tell(`MuJoCo cannot be loaded: ${error.message}`);
      return;
    }
    if (this.app.mode !== "physics") return; // Left again meanwhile.
    this.from = this.app.body.qpos.slice();
    this.drop();
  }

  leave() {
    this.stop();
    this.app.surroundings.restore();
  }

  drop() {
    this.#load();
    const { data, described } = this;
    described.qpos.values.forEach((address, i) => (data.qpos[address] = this.from[i]));
    if (this.action !== "recorded") data.qpos[described.qpos.values[2]] += DROP;
    this.mujoco.mj_forward(this.model, data);
    this.steps = 0;
    this.run();
  }

  // Take the model of the age that is nearest to the one shown, and show that age.
  #load() {
    const { mujoco, app } = this;
    const away = ({ age_months }) => Math.abs(age_months - app.age);
    const chosen = this.described.models.reduce((one, other) => (away(other) < away(one) ? other : one));
    if (this.chosen !== chosen) {
      this.data?.delete();
      this.model?.delete();
      const files = new mujoco.MjVFS();
      for (const [name, { values }] of Object.entries(chosen.files)) files.addBuffer(name, values);
      this.model = mujoco.MjModel.from_xml_string(new TextDecoder().decode(chosen.scene.values), files);
      files.delete();
      this.data = new mujoco.MjData(this.model);
      this.chosen = chosen;
    }
    mujoco.mj_resetData(this.model, this.data);
    app.setAge(chosen.age_months);
    this.timestep = this.model.opt.timestep;
    this.perControl = Math.round(this.described.step_s / this.timestep);
  }

  run() {
    if (this.running || !this.data) return;
    this.running = true;
    this.#label();
    let last = performance.now();
    let owed = 0;
    let measured = { wall: 0, simulated: 0 };
    const frame = (now) => {
      if (!this.running) return;
      const passed = (now - last) / 1000;
      last = now;
      owed = Math.min(owed + passed, BEHIND);
      const steps = Math.floor(owed / this.timestep);
      this.advance(steps);
      owed -= steps * this.timestep;
      measured = { wall: measured.wall + passed, simulated: measured.simulated + steps * this.timestep };
      if (measured.wall > 0.5) {
        this.speed = measured.simulated / measured.wall;
        this.told.textContent = `${this.speed.toFixed(2)} × real time`;
        measured = { wall: 0, simulated: 0 };
      }
      this.show();
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  stop() {
    this.running = false;
    this.#label();
  }

  // Make some physics steps; commands change with each control step.
  advance(steps) {
    for (let step = 0; step < steps; step += 1) {
      if (this.steps % this.perControl === 0) this.#command(this.steps / this.perControl);
      this.#pull();
      this.mujoco.mj_step(this.model, this.data);
      this.steps += 1;
    }
  }

  #command(control) {
    const { ctrl } = this.data;
    const range = this.model.actuator_ctrlrange;
    this.described.commanded.values.forEach((actuator, i) => {
      const [low, high] = [range[2 * actuator], range[2 * actuator + 1]];
      if (this.action === "random") ctrl[actuator] = low + Math.random() * (high - low);
      else if (this.action === "recorded") ctrl[actuator] = Math.min(Math.max(this.recording.action(i, control), low), high);
      else ctrl[actuator] = 0;
    });
  }

  // Part of the body is held, at a point in its frame, and pulled towards a target; or let go.
  pull(hold) {
    this.hold = hold;
  }

  #pull() {
    const { data, model, described } = this;
    data.xfrc_applied.fill(0);
    if (!this.hold) return;
    const body = described.bodies.values[this.hold.number];
    const { places, turns } = this.app.body;
    const point = POINT.copy(this.hold.local).applyQuaternion(turns[this.hold.number]).add(places[this.hold.number]);
    const weight = 9.81 * model.body_subtreemass[described.bodies.values[0]];
    const velocity = VELOCITY.fromArray(data.cvel, 6 * body + 3);
    const force = FORCE.copy(this.hold.target).sub(point).multiplyScalar(STIFFNESS).addScaledVector(velocity, -1.5).clampLength(0, 3).multiplyScalar(weight);
    const arm = point.sub(MIDDLE.fromArray(data.xipos, 3 * body));
    force.toArray(data.xfrc_applied, 6 * body);
    arm.cross(force).toArray(data.xfrc_applied, 6 * body + 3);
  }

  show() {
    const { data, described, app } = this;
    const qpos = new Float32Array(described.qpos.values.length);
    described.qpos.values.forEach((address, i) => (qpos[i] = data.qpos[address]));
    app.surroundings.bodies.forEach((group) => {
      const body = described.around.indexOf(group.name);
      group.position.fromArray(data.xpos, 3 * body);
      const [w, x, y, z] = data.xquat.subarray(4 * body, 4 * body + 4);
      group.quaternion.set(x, y, z, w);
    });
    app.show(qpos);
  }
}

const [POINT, VELOCITY, FORCE, MIDDLE] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];

async function loadEngine(document) {
  const wasmBinary = await unzip(bytesOf(document.getElementById("wasm").textContent));
  return globalThis.loadMujoco({ wasmBinary });
}

