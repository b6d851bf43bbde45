// The infant in the scene: its solids and its skin, which follow its bodies.

import { Group, Matrix4, Vector3 } from "three";
import { Face } from "./face.js";
import { Balls } from "./occlusion.js";
import { makeSolid, scaleSolid } from "./solids.js";
import { Skin } from "./skin.js";

const VISIBLE = 2; // With a skin, the solids under it are in a group after this.
const ONE = new Vector3(1, 1, 1);

export class Infant {
  constructor(body, data, materials) {
    this.body = body;
    this.materials = materials;
    this.scene = new Group();
    this.bodies = body.names.map((name, number) => {
      const group = new Group();
      group.name = name;
      group.userData.body = number;
      group.matrixAutoUpdate = false;
      this.scene.add(group);
      return group;
    });
    this.solids = data.geoms.names.map((name, geom) => this.#solid(data.geoms, name, geom));
    this.face = data.faces && this.solids[data.geoms.names.indexOf(data.faces.geom)];
    this.expressions = data.faces?.materials ?? {};
    this.expression = data.faces?.shown;
    this.faces = Object.values(this.expressions).map((index) => materials[index]);
    this.expressing = new Face(data.faces?.shapes, this.expression);
    this.skin = data.skins && new Skin(data.skins, this.bodies, materials, this.expressing);
    if (this.skin) this.scene.add(this.skin.scene);
    this.resize();
    this.showSkin(Boolean(this.skin));
  }

  #solid({ type, material, body, quat, group, solid: touches }, name, geom) {
    const solid = makeSolid(type.values[geom], this.materials[material.values[geom]]);
    const [w, x, y, z] = quat.values.subarray(4 * geom, 4 * geom + 4);
    solid.name = name;
    solid.quaternion.set(x, y, z, w);
    solid.userData = { geom, type: type.values[geom], group: group.values[geom], touches: Boolean(touches.values[geom]) };
    this.bodies[body.values[geom]].add(solid);
    return solid;
  }

  // Take over sizes that have changed with age.
  resize() {
    for (const solid of this.solids) {
      const { geom, type } = solid.userData;
      solid.position.copy(this.body.geomPlaces[geom]);
      scaleSolid(solid, type, this.body.geomSizes[geom]);
    }
    this.skin?.setAge(this.body.age);
    this.balls = new Balls(this.solids.filter(({ userData }) => userData.touches), this.body.geomSizes);
  }

  // Take over places that have changed.
  follow() {
    this.bodies.forEach((group, number) => {
      group.matrix.compose(this.body.places[number], this.body.turns[number], ONE);
      group.matrixWorldNeedsUpdate = true;
    });
    this.scene.updateMatrixWorld();
    this.balls.follow();
    this.skin?.follow(this.balls.values);
  }

  showSkin(wanted) {
    this.skinned = wanted && Boolean(this.skin);
    if (this.skin) this.skin.scene.visible = this.skinned;
    this.skin?.follow(this.balls.values);
    for (const solid of this.solids) {
      solid.visible = !this.skinned || solid.userData.group <= VISIBLE; // As in MuJoCo's own viewer.
    }
  }

  setExpression(name) {
    this.expression = name;
    const material = this.materials[this.expressions[name]];
    for (const part of this.face?.children ?? []) {
      if (this.faces.includes(part.material)) part.material = material; // With a skin, the pictures are made for it.
    }
    this.skin?.setFace(this.expressions[name], Object.values(this.expressions));
    this.expressing.show(name);
  }

  // Go on to the expression for some seconds; returns whether it is there.
  express(seconds) {
    const isThere = this.expressing.advance(seconds);
    if (this.skin && this.expressing.moves) {
      this.skin.express();
      this.skin.follow(this.balls.values);
    }
    return isThere;
  }
}

export const toLocal = (group, point) => point.clone().applyMatrix4(new Matrix4().copy(group.matrixWorld).invert());
