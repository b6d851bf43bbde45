// The points of the skin at which an infant feels touch.

import { BufferAttribute, BufferGeometry, Color, Points, PointsMaterial, Vector3 } from "three";
import { Ages } from "./ages.js";

const CALM = new Color(0x2f6f8f);
const [LEAST, MOST] = [new Color(0xffc53d), new Color(0xd81e1e)];

export class TouchPoints {
  constructor(data, body) {
    this.data = data;
    this.body = body;
    this.ages = new Ages(data.ages_months);
    this.count = data.body.values.length;
    const geometry = new BufferGeometry();
    for (const name of ["position", "color"]) geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * this.count), 3));
    geometry.setAttribute("load", new BufferAttribute(new Float32Array(this.count), 1));
    const material = new PointsMaterial({ size: 0.0042, vertexColors: true });
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nattribute float load;")
        .replace("gl_PointSize = size;", "gl_PointSize = size * (load > 0.0 ? 2.2 : 1.0); gl_Position.z -= 0.0012 * gl_Position.w;");
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <color_fragment>",
        "#include <color_fragment>\nif (distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;",
      );
    };
    this.scene = new Points(geometry, material);
    this.scene.frustumCulled = false;
    this.scene.visible = false;
    this.setForces([], []);
  }

  setAge(age) {
    this.local = this.ages.blend(this.data.points, age, this.local);
  }

  // Colour the points that feel something, by their numbers and by the forces on them, in [N].
  setForces(points, forces, most = 1) {
    const { color, load } = this.scene.geometry.attributes;
    const shade = new Color();
    for (let i = 0; i < this.count; i += 1) CALM.toArray(color.array, 3 * i);
    load.array.fill(0);
    points.forEach((point, i) => {
      const share = Math.min(Math.sqrt(forces[i] / most), 1);
      shade.lerpColors(LEAST, MOST, share).toArray(color.array, 3 * point);
      load.array[point] = 1;
    });
    color.needsUpdate = load.needsUpdate = true;
  }

  follow() {
    if (!this.scene.visible) return;
    const position = this.scene.geometry.attributes.position;
    for (let i = 0; i < this.count; i += 1) {
      const body = this.data.body.values[i];
      PLACE.fromArray(this.local, 3 * i).applyQuaternion(this.body.turns[body]).add(this.body.places[body]).toArray(position.array, 3 * i);
    }
    position.needsUpdate = true;
  }
}

const PLACE = new Vector3();
