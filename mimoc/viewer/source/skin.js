// The smooth skin of an infant: meshes that its bodies move, as MuJoCo's skins are.

import { BufferAttribute, BufferGeometry, Group, Matrix4, Quaternion, Skeleton, SkinnedMesh, Vector3 } from "three";
import { Ages } from "./ages.js";

const ONE = new Vector3(1, 1, 1);

export class Skin {
  constructor({ ages_months, layers }, bodies, materials) {
    this.ages = new Ages(ages_months);
    this.scene = new Group();
    this.layers = layers.map((layer) => this.#layer(layer, bodies, materials));
  }

  #layer(layer, bodies, materials) {
    const geometry = new BufferGeometry();
    const count = layer.moved_by.shape[0];
    geometry.setIndex(new BufferAttribute(layer.faces.values, 1));
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * count), 3));
    geometry.setAttribute("skinIndex", new BufferAttribute(layer.moved_by.values, 4));
    geometry.setAttribute("skinWeight", new BufferAttribute(layer.weights.values, 4, true));
    if (layer.texcoords) geometry.setAttribute("uv", new BufferAttribute(layer.texcoords.values, 2));
    const bones = Array.from(layer.bones.values, (body) => bodies[body]);
    const mesh = new SkinnedMesh(geometry, materials[layer.material]);
    mesh.skeleton = new Skeleton(bones, bones.map(() => new Matrix4()));
    mesh.bindMode = "detached";
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    mesh.name = layer.name;
    this.scene.add(mesh);
    return { layer, mesh };
  }

  setAge(age) {
    for (const { layer, mesh } of this.layers) {
      const places = this.ages.blend(layer.bind_pos, age);
      const turns = this.ages.blend(layer.bind_quat, age);
      mesh.skeleton.boneInverses.forEach((inverse, bone) => {
        const [w, x, y, z] = turns.subarray(4 * bone, 4 * bone + 4);
        inverse.compose(new Vector3(...places.subarray(3 * bone, 3 * bone + 3)), new Quaternion(x, y, z, w).normalize(), ONE).invert();
      });
      const position = mesh.geometry.getAttribute("position");
      this.ages.blend(layer.verts, age, position.array);
      position.needsUpdate = true;
      mesh.geometry.computeVertexNormals();
    }
  }

  // Show an expression: on the layer whose material is one of the faces.
  setFace(material, faces) {
    for (const { mesh } of this.layers) {
      if (faces.includes(mesh.material)) mesh.material = material;
    }
  }

  follow() {
    for (const { mesh } of this.layers) mesh.skeleton.update();
  }
}
