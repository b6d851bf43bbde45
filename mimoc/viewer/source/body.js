// The kinematics of an infant: from its age, the place of its root and the angles of its joints to its bodies.

import { Quaternion, Vector3 } from "three";
import { Ages } from "./ages.js";

export const ROOT = 7; // Numbers of the root before those of the hinges: place and orientation.

export class Body {
  constructor(data) {
    const { bodies, joints, geoms } = data;
    this.data = data;
    this.ages = new Ages(data.ages_months);
    this.names = bodies.names;
    this.parents = bodies.parent.values;
    this.quats = quaternions(bodies.quat.values);
    this.places = this.names.map(() => new Vector3());
    this.turns = this.names.map(() => new Quaternion());
    this.jointNames = joints.names;
    this.axes = vectors(joints.axis.values);
    this.jointBodies = joints.body.values;
    this.jointsOf = this.names.map((_, body) => this.jointNames.flatMap((_, j) => (this.jointBodies[j] === body ? [j] : [])));
    this.anchors = this.jointNames.map(() => new Vector3()); // In the world, as are:
    this.worldAxes = this.jointNames.map(() => new Vector3());
    this.geomQuats = quaternions(geoms.quat.values);
    this.poses = Object.keys(data.poses);
    this.qpos = new Float32Array(ROOT + this.jointNames.length);
    this.setAge(data.age_months);
  }

  setAge(age) {
    const { bodies, joints, geoms } = this.data;
    this.age = age;
    this.offsets = vectors(this.ages.blend(bodies.pos, age));
    this.jointPlaces = vectors(this.ages.blend(joints.pos, age));
    this.ranges = this.ages.blend(joints.range, age);
    this.geomPlaces = vectors(this.ages.blend(geoms.pos, age));
    this.geomSizes = vectors(this.ages.blend(geoms.size, age));
  }

  // The numbers of a pose at the present age.
  poseOf(name) {
    const found = this.ages.blend(this.data.poses[name], this.age);
    const length = Math.hypot(...found.subarray(3, ROOT));
    for (let i = 3; i < ROOT; i += 1) found[i] /= length;
    return found;
  }

  limits(joint) {
    return [this.ranges[2 * joint], this.ranges[2 * joint + 1]];
  }

  clipped(joint, angle) {
    const [low, high] = this.limits(joint);
    return Math.min(Math.max(angle, low), high);
  }

  // Move all bodies to where the joints say, as MuJoCo's mj_kinematics does.
  move(qpos = this.qpos) {
    this.qpos = qpos;
    const { data } = this;
    for (let body = 0; body < this.names.length; body += 1) {
      const [place, turn] = [this.places[body], this.turns[body]];
      const parent = this.parents[body];
      if (parent < 0) {
        place.set(qpos[0], qpos[1], qpos[2]);
        turn.set(qpos[4], qpos[5], qpos[6], qpos[3]).normalize();
        continue;
      }
      place.copy(this.offsets[body]).applyQuaternion(this.turns[parent]).add(this.places[parent]);
      turn.copy(this.turns[parent]).multiply(this.quats[body]);
      for (const joint of this.jointsOf[body]) {
        const anchor = this.anchors[joint].copy(this.jointPlaces[joint]).applyQuaternion(turn).add(place);
        this.worldAxes[joint].copy(this.axes[joint]).applyQuaternion(turn);
        const angle = qpos[ROOT + joint] - data.joints.reference.values[joint];
        turn.multiply(ANGLE.setFromAxisAngle(this.axes[joint], angle));
        place.copy(this.jointPlaces[joint]).applyQuaternion(turn).negate().add(anchor);
      }
    }
  }

  // The height of the lowest point of its solids.
  lowest() {
    const { body, type, solid } = this.data.geoms;
    let found = Infinity;
    for (let geom = 0; geom < body.values.length; geom += 1) {
      if (!solid.values[geom]) continue;
      const at = body.values[geom];
      const height = MIDDLE.copy(this.geomPlaces[geom]).applyQuaternion(this.turns[at]).add(this.places[at]).z;
      const turn = ANGLE.copy(this.turns[at]).multiply(this.geomQuats[geom]).invert();
      const down = MIDDLE.set(0, 0, 1).applyQuaternion(turn);
      found = Math.min(found, height - reach(type.values[geom], this.geomSizes[geom], down));
    }
    return found;
  }

  // Middle and radius of a ball around its bodies.
  extent() {
    const middle = new Vector3();
    for (const place of this.places) middle.add(place);
    middle.divideScalar(this.places.length);
    const farthest = Math.max(...this.places.map((place) => place.distanceTo(middle)));
    return { middle, radius: farthest + 0.06 };
  }
}

const ANGLE = new Quaternion();
const MIDDLE = new Vector3();

export const SPHERE = 2;
export const CAPSULE = 3;
export const ELLIPSOID = 4;
export const CYLINDER = 5;
export const BOX = 6;
export const PLANE = 0;
export const MESH = 7;

// How far a solid reaches from its middle along a direction in its own frame.
function reach(type, size, { x, y, z }) {
  if (type === SPHERE) return size.x;
  if (type === CAPSULE) return size.x + size.y * Math.abs(z);
  if (type === ELLIPSOID) return Math.hypot(size.x * x, size.y * y, size.z * z);
  if (type === CYLINDER) return size.x * Math.hypot(x, y) + size.y * Math.abs(z);
  return size.x * Math.abs(x) + size.y * Math.abs(y) + size.z * Math.abs(z);
}

export function vectors(values) {
  return Array.from({ length: values.length / 3 }, (_, i) => new Vector3(...values.subarray(3 * i, 3 * i + 3)));
}

// MuJoCo writes quaternions with the real part first.
export function quaternions(values) {
  return Array.from({ length: values.length / 4 }, (_, i) => {
    const [w, x, y, z] = values.subarray(4 * i, 4 * i + 4);
    return new Quaternion(x, y, z, w);
  });
}
