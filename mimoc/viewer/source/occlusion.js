// What parts of the body hide of the sky from each other, and from the floor: balls that stand for its solids.

import { Vector3 } from "three";
import { BOX, CAPSULE, CYLINDER, ELLIPSOID, SPHERE } from "./body.js";

const LEAST = 0.011; // Metres: smaller balls hide nothing, such as fingers.
const WITHIN = 0.92; // Of a solid's radius, as the skin dips into solids in places.
const POINT = new Vector3();

// Where balls stand on a solid's axis, by its half length, and their radius.
const SHAPES = {
  [SPHERE]: ({ x }) => [x, [0]],
  [CAPSULE]: ({ x, y }) => [x, y > x / 2 ? [-y, 0, y] : [0]],
  [CYLINDER]: ({ x, y }) => [x, y > x ? [-y / 2, y / 2] : [0]],
  [ELLIPSOID]: ({ x, y, z }) => [Math.cbrt(x * y * z), [0]],
  [BOX]: ({ x, y, z }) => [Math.cbrt(x * y * z), [0]],
};

export class Balls {
  constructor(solids, sizes) {
    this.places = solids.flatMap((solid) => {
      const { geom, type } = solid.userData;
      const [radius, along] = SHAPES[type]?.(sizes[geom]) ?? [0, []];
      return radius < LEAST ? [] : along.map((z) => ({ solid, z, radius: WITHIN * radius }));
    });
    this.values = new Float32Array(4 * this.places.length); // x, y, z and radius of one after another.
  }

  // Take over where the solids are.
  follow() {
    this.places.forEach(({ solid, z, radius }, ball) => {
      POINT.set(0, 0, z).applyQuaternion(solid.quaternion).add(solid.position).applyMatrix4(solid.parent.matrixWorld);
      this.values.set([POINT.x, POINT.y, POINT.z, radius], 4 * ball);
    });
    return this.values;
  }
}

const [FAR, FLOOR] = [0.02, 0.07]; // The least share of the sky that counts; metres above the floor where it gets light.

// Write how light each vertex is, by what balls and the floor hide from it, warmer where light comes through skin.
export function darken(points, normals, balls, colours) {
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, z, a, b, c] = [points[i], points[i + 1], points[i + 2], normals[i], normals[i + 1], normals[i + 2]];
    let share = Math.max(0, -c) * Math.max(0, 1 - Math.max(z, 0) / FLOOR);
    for (let ball = 0; ball < balls.length; ball += 4) {
      const [dx, dy, dz, radius] = [balls[ball] - x, balls[ball + 1] - y, balls[ball + 2] - z, balls[ball + 3]];
      const towards = dx * a + dy * b + dz * c;
      if (towards <= 0) continue;
      const square = dx * dx + dy * dy + dz * dz;
      const size = (radius * radius) / square;
      if (size > FAR) share += (Math.min(size, 1) * towards) / Math.sqrt(square);
    }
    const light = Math.exp(-0.75 * share);
    colours[i] = 0.25 + 0.75 * light;
    colours[i + 1] = 0.12 + 0.88 * light;
    colours[i + 2] = 0.08 + 0.92 * light;
  }
}
