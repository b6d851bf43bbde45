// The eyes: their fields of view in the scene, and what they see, in two small pictures.

import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, PerspectiveCamera, Color } from "three";
import { quaternions, vectors } from "./body.js";

const REACH = 0.3; // Metres of the field of view that are drawn.
const SKY = new Color(0xf3ece1);

export class Eyes {
  // What they see is drawn over the places, elements of the page with the names of the eyes.
  constructor(data, infant, places) {
    this.data = data;
    this.places = places;
    this.infant = infant;
    this.turns = quaternions(data.quat.values);
    this.cameras = data.names.map((_, eye) => {
      const camera = new PerspectiveCamera(data.fovy_deg.values[eye], 1, 0.01, 30);
      camera.add(makeFrustum(data.fovy_deg.values[eye], eye ? 0xc9742f : 0x2f7d78));
      infant.bodies[data.body.values[eye]].add(camera);
      camera.quaternion.copy(this.turns[eye]);
      return camera;
    });
    this.frusta = this.cameras.map((camera) => camera.children[0]);
    // An eye does not see the head that it is in.
    const { parents } = infant.body;
    const heads = new Set(Array.from(data.body.values).flatMap((body) => [body, parents[body]]));
    this.unseen = infant.solids.filter((solid) => heads.has(infant.bodies.indexOf(solid.parent)));
    this.unseenSkins = (infant.skin?.layers ?? []).filter(({ layer }) => layer.bones.values.every((body) => heads.has(body))).map(({ mesh }) => mesh);
    this.recorded = []; // Videos to be shown instead of what they would see here.
    this.show(false);
  }

  show(wanted) {
    this.shown = wanted;
    for (const frustum of this.frusta) frustum.visible = wanted;
  }

  setAge(age) {
    const places = vectors(this.infant.body.ages.blend(this.data.pos, age));
    this.cameras.forEach((camera, eye) => camera.position.copy(places[eye]));
  }

  // Draw what each eye sees where the page has its place, whatever the layout.
  draw({ renderer, scene, canvas, light: { floor } }) {
    if (!this.shown || this.recorded.length) return;
    const box = canvas.getBoundingClientRect();
    const hidden = [...this.frusta, ...[...this.unseen, ...this.unseenSkins].filter((each) => each.visible)];
    for (const each of hidden) each.visible = false;
    floor.ground.visible = true;
    renderer.setScissorTest(true);
    this.cameras.forEach((camera, eye) => {
      const place = this.places[eye].getBoundingClientRect();
      const area = [place.left - box.left, box.bottom - place.bottom, place.width, place.height];
      renderer.setViewport(...area);
      renderer.setScissor(...area);
      renderer.setClearColor(SKY, 1);
      renderer.clear();
      renderer.render(scene, camera);
    });
    renderer.setScissorTest(false);
    renderer.setClearColor(0, 0);
    renderer.setViewport(0, 0, canvas.clientWidth, canvas.clientHeight);
    for (const each of hidden) each.visible = true;
    floor.ground.visible = false;
  }
}

function makeFrustum(fovy, colour) {
  const half = REACH * Math.tan((fovy * Math.PI) / 360);
  const corners = [[-half, -half], [half, -half], [half, half], [-half, half]].map(([x, y]) => [x, y, -REACH]);
  const sides = corners.flatMap((corner, i) => [[0, 0, 0], corner, corners[(i + 1) % 4]]);
  const edges = corners.flatMap((corner, i) => [[0, 0, 0], corner, corner, corners[(i + 1) % 4]]);
  const frustum = new Group();
  const glass = new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.1, side: DoubleSide, depthWrite: false });
  frustum.add(new Mesh(geometryOf(sides), glass), new LineSegments(geometryOf(edges), new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.7 })));
  return frustum;
}

function geometryOf(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.flat()), 3));
  return geometry;
}
