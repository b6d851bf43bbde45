// MuJoCo's solids as meshes of three.js: each is made of parts of unit size, which are scaled.

import { BoxGeometry, BufferAttribute, BufferGeometry, CylinderGeometry, Group, Mesh, PlaneGeometry, SphereGeometry } from "three";
import { BOX, CAPSULE, CYLINDER, ELLIPSOID, MESH, PLANE, SPHERE } from "./body.js";

const upright = (geometry) => geometry.rotateX(Math.PI / 2); // From y up to z up.
const BALL = upright(new SphereGeometry(1, 32, 20));
const TOP = upright(new SphereGeometry(1, 32, 10, 0, 2 * Math.PI, 0, Math.PI / 2));
const BOTTOM = upright(new SphereGeometry(1, 32, 10, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2));
const TUBE = upright(new CylinderGeometry(1, 1, 2, 32, 1, true));
const ROD = upright(new CylinderGeometry(1, 1, 2, 32, 1));
const BRICK = new BoxGeometry(2, 2, 2);
const SHEET = new PlaneGeometry(2, 2);

export function makeSolid(type, material, mesh) {
  const solid = new Group();
  const geometries = { [SPHERE]: [BALL], [CAPSULE]: [TUBE, TOP, BOTTOM], [ELLIPSOID]: [BALL], [CYLINDER]: [ROD], [BOX]: [BRICK], [PLANE]: [SHEET], [MESH]: [mesh] };
  for (const geometry of geometries[type] ?? []) {
    const part = new Mesh(geometry, material);
    part.castShadow = part.receiveShadow = type !== PLANE;
    solid.add(part);
  }
  return solid;
}

export function scaleSolid(solid, type, size) {
  const parts = solid.children;
  if (type === SPHERE) parts[0].scale.setScalar(size.x);
  else if (type === ELLIPSOID || type === BOX) parts[0].scale.copy(size);
  else if (type === CYLINDER) parts[0].scale.set(size.x, size.x, size.y);
  else if (type === PLANE) parts[0].scale.set(size.x || 5, size.y || 5, 1);
  else if (type === CAPSULE) {
    parts[0].scale.set(size.x, size.x, size.y);
    parts[1].scale.setScalar(size.x);
    parts[2].scale.setScalar(size.x);
    parts[1].position.z = size.y;
    parts[2].position.z = -size.y;
  }
}

export function meshOf({ verts, faces }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(verts.values, 3));
  geometry.setIndex(new BufferAttribute(faces.values, 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

