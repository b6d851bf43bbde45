// The infant and everything around it: what the controls of the page change, and what follows from that.

import { Quaternion, Vector3 } from "three";
import { Body, ROOT } from "./body.js";
import { Charts } from "./charts.js";
import { Dragging, reachFor } from "./dragging.js";
import { Eyes } from "./eyes.js";
import { Infant } from "./infant.js";
import { makeMaterials, readTextures } from "./materials.js";
import { Stage } from "./stage.js";
import { Surroundings } from "./surroundings.js";
import { TouchPoints } from "./touch.js";

const OLDEST = 24;
const UP = new Vector3(0, 0, 1);
const STANDING = new Vector3(1, 0.55, 0.3);
const LYING = new Vector3(0.75, 1, 0.9);

export class App {
  constructor(data, textures, document) {
    this.data = data;
    this.page = document;
    this.materials = makeMaterials(data.materials, textures);
    this.body = new Body(data);
    this.stage = new Stage(document.getElementById("canvas"));
    this.infant = new Infant(this.body, data, this.materials);
    this.eyes = new Eyes(data.eyes, this.infant, [...document.getElementById("seen").children]);
    this.touch = data.touch && new TouchPoints(data.touch, this.body);
    this.surroundings = new Surroundings(data, this.materials);
    if (!this.surroundings.isEmpty) this.stage.light.reach = 2.5;
    this.charts = new Charts(data);
    this.stage.scene.add(this.infant.scene, this.surroundings.scene, ...(this.touch ? [this.touch.scene] : []));
    this.stage.after.push(() => this.eyes.draw(this.stage));
    this.changed = []; // Called whenever the infant has moved.
    this.own = new Map(); // Angles of joints that are not those of the pose.
    this.pose = data.pose in data.poses ? data.pose : this.body.poses[0];
    this.mode = "pose"; // Or "recording", or "physics": what moves the infant.
    this.dragging = new Dragging(this.stage, this.infant, {
      trunk: data.trunk,
      allowed: () => this.mode !== "recording",
      needsJoints: () => this.mode !== "physics", // There, anything can be pulled.
      moved: (hold, chain) => this.pull(hold, chain),
    });
    this.setAge(data.age_months);
    this.look();
  }

  setAge(age) {
    this.age = age;
    this.body.setAge(age);
    this.infant.resize();
    this.touch?.setAge(age);
    this.eyes.setAge(age);
    const measures = this.charts.setAge(age);
    this.page.getElementById("facts").textContent =
      `${ageText(age)} · ${measures.length_cm.toFixed(1)} cm · ${measures.weight_kg.toFixed(1)} kg`;
    if (this.mode === "pose") this.#takePose();
  }

  setPose(pose) {
    if (this.mode === "recording") this.enter("pose");
    this.pose = pose;
    this.own.clear();
    this.#takePose();
    this.look();
  }

  setJoint(joint, angle) {
    if (this.mode !== "pose") return;
    this.own.set(joint, angle);
    this.#takePose();
  }

  // Let the face go to an expression.
  setExpression(name) {
    this.infant.setExpression(name);
    let last = performance.now();
    const go = (now) => {
      const isThere = this.infant.express(Math.max(now - last, 1) / 1000);
      last = now;
      this.stage.drawMoved();
      this.expressing = isThere ? null : requestAnimationFrame(go);
    };
    this.expressing ??= requestAnimationFrame(go);
  }

  // The pose at this age, with joints that were moved; as high above the floor as the pose is.
  #takePose() {
    const { body } = this;
    body.move(body.poseOf(this.pose));
    this.height = body.lowest();
    for (const [joint, angle] of this.own) body.qpos[ROOT + joint] = body.clipped(joint, angle);
    body.move();
    body.qpos[2] += this.height - body.lowest();
    this.show();
  }

  // Show a state of the body.
  show(qpos = this.body.qpos) {
    this.body.move(qpos);
    this.infant.follow();
    this.touch?.follow();
    if (this.middle) {
      const { middle } = this.body.extent();
      this.stage.follow(middle.clone().sub(this.middle).add(this.stage.controls.target));
      this.middle = middle;
      this.stage.light.aim(middle, this.radius);
    }
    for (const each of this.changed) each();
    this.#darkenFloor();
    this.stage.drawMoved();
  }

  #darkenFloor() {
    this.stage.light.floor.darken(this.infant.balls.values);
  }

  // Part of the body is held and pulled.
  pull(hold, chain) {
    if (this.mode === "physics") this.physics.pull(hold);
    if (this.mode !== "pose" || !hold) return;
    const before = this.middle;
    this.middle = null; // The camera stays while someone drags.
    reachFor(this.body, chain, hold);
    for (const joint of chain) this.own.set(joint, this.body.qpos[ROOT + joint]);
    const below = this.body.lowest() - Math.min(this.height, 0); // A pose may press into the floor a little.
    if (below < 0) this.body.qpos[2] -= below;
    this.show();
    this.middle = before && this.body.extent().middle;
  }

  // Turn the camera to the infant, from where it would be seen well at any age.
  look() {
    const { body } = this;
    const qpos = body.qpos;
    const now = body.extent();
    let { radius } = now;
    if (this.mode === "pose") {
      const age = body.age;
      body.setAge(OLDEST);
      body.move(body.poseOf(this.pose));
      radius = body.extent().radius;
      body.setAge(age);
      body.move(qpos);
    }
    const root = new Quaternion(qpos[4], qpos[5], qpos[6], qpos[3]);
    const left = new Vector3(0, 1, 0).applyQuaternion(root); // Stays level, whether it lies, sits or stands.
    const isLying = Math.abs(new Vector3(0, 0, 1).applyQuaternion(root).z) < 0.5;
    const view = (isLying ? LYING : STANDING).clone().applyAxisAngle(UP, Math.atan2(-left.x, left.y));
    this.middle = now.middle;
    this.radius = radius;
    this.stage.frame({ middle: now.middle, radius: 1.12 * radius }, view);
    this.#darkenFloor();
  }

  showEyes(wanted) {
    this.eyes.show(wanted);
    this.page.getElementById("seen").hidden = !wanted;
    this.eyes.places.forEach((place, eye) => {
      const { video } = this.eyes.recorded.find(({ name }) => name === this.data.eyes.names[eye]) ?? {};
      place.querySelector("video")?.remove();
      place.hidden = eye >= this.data.eyes.names.length;
      place.querySelector("figcaption").textContent = this.data.eyes.names[eye] === "eye_right" ? "Right eye" : "Left eye";
      if (video) place.append(video);
    });
    this.stage.draw();
  }

  showTouch(wanted) {
    this.touch.scene.visible = wanted;
    this.touch.follow();
    this.stage.draw();
  }

  // End it, so that the page can show another infant.
  close() {
    this.enter("pose");
    this.stage.renderer.dispose();
    this.stage.renderer.forceContextLoss();
  }

  tell(message) {
    this.page.getElementById("message").textContent = message;
  }
}

export async function openApp(data, document) {
  return new App(data, await readTextures(data.textures), document);
}

export function ageText(age) {
  if (age < 0.05) return "Newborn";
  const months = age < 3 ? Math.round(age * 10) / 10 : Math.round(age * 2) / 2;
  return `${months} ${months === 1 ? "month" : "months"}`;
}
