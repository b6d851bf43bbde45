// The scene and its camera; it is drawn only when something has changed.

import { NoToneMapping, PCFShadowMap, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Light } from "./light.js";
import { drawsQuickly, Sharpness } from "./sharpness.js";

const FIELD_OF_VIEW = 24; // Narrow, from far away, which leaves heads round.
const LEFT = 0.05; // Radians that an arrow key turns the camera by.
const REST = 200; // Milliseconds without motion, after which a sharp picture is drawn.

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.sharpness = new Sharpness(drawsQuickly());
    this.renderer = new WebGLRenderer({ canvas, antialias: this.sharpness.quick, alpha: true });
    this.renderer.toneMapping = NoToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false; // Only when something has moved: half of a picture's time without a GPU.
    this.renderer.autoClear = false;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 60);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableDamping: true, dampingFactor: 0.12, minDistance: 0.25, maxDistance: 8, maxPolarAngle: 1.65, rotateSpeed: 0.8 });
    this.controls.addEventListener("change", () => this.draw());
    this.before = []; // Called before each picture, and
    this.after = []; // after it.
    this.light = new Light(this.scene);
    canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.frames = 0;
  }

  // Look at a ball from the front left, a little from above.
  frame({ middle, radius }, direction = new Vector3(1, 0.62, 0.34)) {
    const half = (Math.min(this.camera.aspect, 1) * this.camera.fov * Math.PI) / 360;
    this.controls.target.copy(middle);
    this.camera.position.copy(direction).normalize().multiplyScalar(radius / Math.sin(half)).add(middle);
    this.controls.update();
    this.light.aim(middle, radius);
    this.draw();
  }

  // Follow what is looked at.
  follow(middle) {
    const way = middle.clone().sub(this.controls.target);
    this.controls.target.add(way);
    this.camera.position.add(way);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.renderer.setPixelRatio(this.sharpness.resting);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    this.render();
  }

  // Draw a picture soon in which something has moved.
  drawMoved() {
    this.renderer.shadowMap.needsUpdate = true;
    this.draw();
  }

  // Draw a picture soon; many calls make one picture.
  draw() {
    if (this.waiting) return;
    const asked = performance.now();
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null;
      this.controls.update();
      this.sharpness.tell(performance.now() - asked);
      this.#renderAt(this.sharpness.moving);
      clearTimeout(this.rest);
      this.rest = setTimeout(() => this.waiting || this.#renderAt(this.sharpness.resting), REST);
    });
  }

  #renderAt(ratio) {
    const isNew = ratio !== this.renderer.getPixelRatio();
    if (isNew) this.renderer.setPixelRatio(ratio);
    if (isNew || ratio === this.sharpness.moving) this.render();
  }

  render() {
    for (const each of this.before) each();
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    for (const each of this.after) each();
    this.frames += 1;
  }

  // What is under the pointer, nearest first, of some objects.
  under(event, objects) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    this.raycaster ??= new Raycaster();
    this.raycaster.setFromCamera(at, this.camera);
    return this.raycaster.intersectObjects(objects, true);
  }

  // Turn the camera around what it looks at, by angles across and up.
  turn(across, up) {
    const away = this.camera.position.clone().sub(this.controls.target);
    away.applyAxisAngle(this.camera.up, across);
    const height = Math.min(Math.max(Math.asin(away.z / away.length()) - up, -0.07), 1.5);
    const [length, around] = [away.length(), Math.atan2(away.y, away.x)];
    away.set(Math.cos(height) * Math.cos(around), Math.cos(height) * Math.sin(around), Math.sin(height)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(away);
    this.draw();
  }

  #approach(share) {
    this.camera.position.sub(this.controls.target).multiplyScalar(share).add(this.controls.target);
    this.draw();
  }

  #key(event) {
    const turns = { ArrowLeft: [-LEFT, 0], ArrowRight: [LEFT, 0], ArrowUp: [0, -LEFT], ArrowDown: [0, LEFT] };
    const nearer = { "+": 0.92, "=": 0.92, "-": 1.08 };
    if (event.key in turns) this.turn(...turns[event.key]);
    else if (event.key in nearer) this.#approach(nearer[event.key]);
    else return;
    event.preventDefault();
  }
}
