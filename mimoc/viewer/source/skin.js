// The smooth skin of an infant: meshes that its bodies move, as MuJoCo's skins are. Vertices are moved here and not by the
// graphics card: there are few, they are needed for shadow, picture and eyes, and machines without a card draw twice as fast.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, Matrix4, Mesh, Quaternion, Vector3 } from "three";
import { Ages } from "./ages.js";
import { darken } from "./occlusion.js";
import { findSeams, joinNormals } from "./seams.js";

const ONE = new Vector3(1, 1, 1);
const MOVERS = 4; // Bodies that move a vertex, at most; the strongest comes first.

export class Skin {
  constructor({ ages_months, layers }, bodies, materials, face) {
    this.ages = new Ages(ages_months);
    this.face = face;
    this.scene = new Group();
    this.materials = new Map(); // Those of the layers, with the light that reaches each vertex, by number.
    this.dress = (number) => {
      if (!this.materials.has(number)) this.materials.set(number, Object.assign(materials[number].clone(), { vertexColors: true }));
      return this.materials.get(number);
    };
    this.layers = layers.map((layer) => this.#layer(layer, bodies));
  }

  #layer(layer, bodies) {
    const bound = new BufferGeometry(); // As it is before the bodies move it.
    const moved = new BufferGeometry();
    for (const geometry of [bound, moved]) {
      geometry.setIndex(new BufferAttribute(layer.faces.values, 1));
      for (const name of ["position", "normal"]) {
        const attribute = new BufferAttribute(new Float32Array(3 * layer.moved_by.shape[0]), 3);
        geometry.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
      }
    }
    moved.setAttribute("color", new BufferAttribute(new Float32Array(3 * layer.moved_by.shape[0]), 3).setUsage(DynamicDrawUsage));
    if (layer.texcoords) {
      const places = changes(layer.texcoords) ? this.ages.blend(layer.texcoords, 0) : layer.texcoords.values;
      moved.setAttribute("uv", new BufferAttribute(places, 2));
    }
    const mesh = new Mesh(moved, this.dress(layer.material));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    mesh.name = layer.name;
    this.scene.add(mesh);
    const bones = Array.from(layer.bones.values, (body) => ({ body: bodies[body], unbind: new Matrix4() }));
    return { layer, mesh, bones, bound, turns: new Float32Array(12 * bones.length) };
  }

  setAge(age) {
    this.age = age;
    for (const { layer, bones, bound } of this.layers) {
      const places = this.ages.blend(layer.bind_pos, age);
      const turns = this.ages.blend(layer.bind_quat, age);
      bones.forEach(({ unbind }, bone) => {
        const [w, x, y, z] = turns.subarray(4 * bone, 4 * bone + 4);
        unbind.compose(new Vector3(...places.subarray(3 * bone, 3 * bone + 3)), new Quaternion(x, y, z, w).normalize(), ONE).invert();
      });
    }
    this.express();
  }

  // Give the skin its shape before the bodies move it: that of its age, with the expression.
  express() {
    for (const { layer, mesh, bound } of this.layers) {
      const { uv } = mesh.geometry.attributes;
      if (uv && changes(layer.texcoords)) {
        this.ages.blend(layer.texcoords, this.age, uv.array);
        uv.needsUpdate = true;
      }
      const positions = this.ages.blend(layer.verts, this.age, bound.getAttribute("position").array);
      this.face?.deform(layer.name, this.age, positions);
      bound.computeVertexNormals();
    }
    const arrays = (name) => this.layers.map(({ bound }) => bound.getAttribute(name).array);
    this.seams ??= findSeams(arrays("position"));
    joinNormals(this.seams, arrays("normal"));
  }

  // Show a picture of a face on the layer that has one, of all that there are, by number.
  setFace(number, faces) {
    for (const { layer, mesh } of this.layers) {
      if (faces.includes(layer.material)) mesh.material = this.dress(number);
    }
  }

  // Take over where the bodies are, and what balls hide from each vertex.
  follow(balls) {
    if (!this.scene.visible) return;
    for (const { layer, mesh, bones, bound, turns } of this.layers) {
      bones.forEach(({ body, unbind }, bone) => rowsOf(MOVE.multiplyMatrices(body.matrix, unbind), turns, 12 * bone));
      const { position, normal, color } = mesh.geometry.attributes;
      moveVertices(layer, turns, bound.attributes, mesh.geometry.attributes);
      darken(position.array, normal.array, balls, color.array);
      color.needsUpdate = true;
    }
  }
}

const changes = ({ shape }) => shape.length > 2; // By age, as where hair is painted does.
const MOVE = new Matrix4();
const BLEND = new Float64Array(12);

// Write the first three rows of a matrix, one after another.
function rowsOf({ elements }, out, at) {
  for (let row = 0; row < 3; row += 1) {
    for (let column = 0; column < 4; column += 1) out[at + 4 * row + column] = elements[4 * column + row];
  }
}

// Move points and normals by the weighted mean of the motions of their bodies; the shader gives normals length one.
function moveVertices({ moved_by, weights }, turns, { position: from, normal: along }, { position, normal }) {
  const [at, facing, to, towards] = [from.array, along.array, position.array, normal.array];
  for (let vertex = 0; vertex < at.length / 3; vertex += 1) {
    blend(moved_by.values, weights.values, MOVERS * vertex, turns);
    const [i, j, k] = [3 * vertex, 3 * vertex + 1, 3 * vertex + 2];
    for (let row = 0; row < 3; row += 1) {
      const [a, b, c] = [BLEND[4 * row], BLEND[4 * row + 1], BLEND[4 * row + 2]];
      to[i + row] = a * at[i] + b * at[j] + c * at[k] + BLEND[4 * row + 3];
      towards[i + row] = a * facing[i] + b * facing[j] + c * facing[k];
    }
  }
  position.needsUpdate = normal.needsUpdate = true;
}

function blend(movers, weights, first, turns) {
  BLEND.fill(0);
  for (let mover = first; mover < first + MOVERS && weights[mover]; mover += 1) {
    const [share, at] = [weights[mover] / 255, 12 * movers[mover]];
    for (let i = 0; i < 12; i += 1) BLEND[i] += share * turns[at + i];
  }
}
