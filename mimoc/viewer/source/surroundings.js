// What is around the infant: furniture and toys, which stay as they are at the age of its spec.

import { Group, Vector3 } from "three";
import { PLANE, quaternions, vectors } from "./body.js";
import { plainMaterial } from "./materials.js";
import { makeSolid, meshOf, scaleSolid } from "./solids.js";

export class Surroundings {
  constructor({ surroundings: { bodies, geoms, meshes } }, materials) {
    this.scene = new Group();
    const [places, turns] = [vectors(bodies.pos.values), quaternions(bodies.quat.values)];
    this.bodies = bodies.names.map((name, i) => {
      const group = new Group();
      group.name = name;
      group.position.copy(places[i]);
      group.quaternion.copy(turns[i]);
      this.scene.add(group);
      return group;
    });
    const made = meshes.map(meshOf);
    const [middles, tilts, sizes] = [vectors(geoms.pos.values), quaternions(geoms.quat.values), vectors(geoms.size.values)];
    geoms.names.forEach((_, geom) => {
      const type = geoms.type.values[geom];
      if (type === PLANE && isFloor(tilts[geom])) return; // The page has a floor of its own.
      const number = geoms.material.values[geom];
      const material = number >= 0 ? materials[number] : plainMaterial(geoms.rgba.values.subarray(4 * geom, 4 * geom + 4));
      const solid = makeSolid(type, material, made[geoms.mesh.values[geom]]);
      scaleSolid(solid, type, sizes[geom]);
      solid.position.copy(middles[geom]);
      solid.quaternion.copy(tilts[geom]);
      this.bodies[geoms.body.values[geom]].add(solid);
      this.isEmpty = false;
    });
    this.isEmpty ??= true;
    this.start = Float32Array.from(places.flatMap((place, i) => [...place.toArray(), turns[i].w, turns[i].x, turns[i].y, turns[i].z]));
  }

  // Put the bodies back to where they were.
  restore() {
    this.place(this.start);
  }

  // Put the bodies where they are now: places and orientations, one after another.
  place(values) {
    this.bodies.forEach((group, i) => {
      const [x, y, z, w, a, b, c] = values.subarray(7 * i, 7 * i + 7);
      group.position.set(x, y, z);
      group.quaternion.set(a, b, c, w);
    });
  }
}

const isFloor = (tilt) => new Vector3(0, 0, 1).applyQuaternion(tilt).z > 0.99;
