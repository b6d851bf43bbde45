// Dragging parts of the body: the joints above what is held turn, within their limits, until it follows the pointer.

import { Plane, Vector3 } from "three";
import { ROOT } from "./body.js";
import { toLocal } from "./infant.js";

const ROUNDS = 12;
const STEP = 0.6; // Of the angle that would bring a joint's part nearest, how much it turns at once.

export class Dragging {
  // `moved` is called after each move.
  constructor(stage, infant, { trunk, moved, needsJoints, allowed }) {
    Object.assign(this, { stage, infant, body: infant.body, trunk, moved, needsJoints, allowed });
    const { canvas } = stage;
    canvas.addEventListener("pointerdown", (event) => this.#take(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => this.#leave());
  }

  #under(event) {
    const [hit] = this.stage.under(event, this.infant.solids);
    return hit && { point: hit.point, group: hit.object.parent.parent };
  }

  #take(event) {
    if (event.button !== 0 || !this.allowed()) return;
    const hit = this.#under(event);
    if (!hit) return;
    const number = hit.group.userData.body;
    this.chain = chainOf(this.body, number, this.trunk);
    if (!this.chain.length && this.needsJoints()) return;
    this.hold = { group: hit.group, number, local: toLocal(hit.group, hit.point), target: hit.point.clone() };
    const facing = this.stage.camera.getWorldDirection(new Vector3());
    this.plane = new Plane().setFromNormalAndCoplanarPoint(facing, hit.point);
    this.stage.controls.enabled = false;
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.stage.canvas.classList.add("holding");
  }

  #move(event) {
    if (!this.hold) {
      if (event.buttons === 0) this.stage.canvas.classList.toggle("over", this.allowed() && Boolean(this.#under(event)));
      return;
    }
    this.stage.under(event, []);
    if (!this.stage.raycaster.ray.intersectPlane(this.plane, this.hold.target)) return;
    this.moved(this.hold, this.chain);
  }

  #leave() {
    if (!this.hold) return;
    this.hold = null;
    this.stage.controls.enabled = true;
    this.stage.canvas.classList.remove("holding");
    this.moved(null, []);
  }
}

// The joints that follow when a part is held, from it towards the trunk: those of its limb, or of the trunk itself.
function chainOf(body, number, trunk) {
  const inTrunk = (index) => trunk.includes(body.names[index]);
  const stay = !inTrunk(number);
  const found = [];
  for (let at = number; at >= 0 && !(stay && inTrunk(at)); at = body.parents[at]) found.push(...[...body.jointsOf[at]].reverse());
  return found;
}

// Turn the joints of a chain so that a point of a body comes near a target (cyclic coordinate descent).
export function reachFor(body, chain, { number, local, target }) {
  const [point, from, to] = [new Vector3(), new Vector3(), new Vector3()];
  for (let round = 0; round < ROUNDS; round += 1) {
    for (const joint of chain) {
      const [axis, anchor] = [body.worldAxes[joint], body.anchors[joint]];
      point.copy(local).applyQuaternion(body.turns[number]).add(body.places[number]);
      from.copy(point).sub(anchor).projectOnPlane(axis);
      to.copy(target).sub(anchor).projectOnPlane(axis);
      if (Math.min(from.length(), to.length()) < 0.004) continue;
      const angle = Math.atan2(from.clone().cross(to).dot(axis), from.dot(to));
      body.qpos[ROOT + joint] = body.clipped(joint, body.qpos[ROOT + joint] + STEP * angle);
      body.move();
    }
  }
}
