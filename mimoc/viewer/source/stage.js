// The scene with its light, floor and camera; it is drawn only when something has changed.

import { AmbientLight, CircleGeometry, DirectionalLight, HemisphereLight, Mesh, MeshBasicMaterial, NoToneMapping, PCFShadowMap, PerspectiveCamera, Raycaster, Scene, ShaderMaterial, ShadowMaterial, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD_OF_VIEW = 24; // Narrow, from far away, which leaves heads round.
const LEFT = 0.05; // Radians that an arrow key turns the camera by.

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
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
    this.#light();
    this.floor = makeFloor();
    this.scene.add(...Object.values(this.floor));
    canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.frames = 0;
  }

  #light() {
    this.sun = new DirectionalLight(0xfff4e6, 1.9);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 5;
    this.sun.shadow.normalBias = 0.006;
    const fill = new DirectionalLight(0xfff2e4, 0.75);
    fill.position.set(2, 0.4, 0.5);
    this.scene.add(this.sun, this.sun.target, fill, new HemisphereLight(0xffffff, 0xeadbc6, 1.35), new AmbientLight(0xffffff, 0.35));
  }

  // Look at a ball from the front left, a little from above.
  frame({ middle, radius }, direction = new Vector3(1, 0.62, 0.34)) {
    const half = (Math.min(this.camera.aspect, 1) * this.camera.fov * Math.PI) / 360;
    this.controls.target.copy(middle);
    this.camera.position.copy(direction).normalize().multiplyScalar(radius / Math.sin(half)).add(middle);
    this.controls.update();
    this.lightUp(middle, radius);
    this.draw();
  }

  // Follow what is looked at.
  follow(middle) {
    const way = middle.clone().sub(this.controls.target);
    this.controls.target.add(way);
    this.camera.position.add(way);
  }

  lightUp(middle, radius) {
    const { camera } = this.sun.shadow;
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).add(new Vector3(1.2, 0.9, 2.4));
    Object.assign(camera, { left: -1.6 * radius, right: 1.6 * radius, top: 1.6 * radius, bottom: -1.6 * radius, near: 0.3, far: 6 });
    camera.updateProjectionMatrix();
    this.floor.lines.material.uniforms.middle.value.set(middle.x, middle.y);
    for (const each of [this.floor.lines, this.floor.shadow]) each.position.set(middle.x, middle.y, each.position.z);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
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
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.controls.update();
      this.render();
    });
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

  #key(event) {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const away = this.camera.position.clone().sub(this.controls.target);
    if (event.key in turns) {
      const [across, up] = turns[event.key];
      away.applyAxisAngle(this.camera.up, across * LEFT);
      const flat = Math.hypot(away.x, away.y);
      const height = Math.min(Math.max(Math.atan2(away.z, flat) - up * LEFT, -0.07), 1.5);
      const [length, around] = [away.length(), Math.atan2(away.y, away.x)];
      away.set(Math.cos(height) * Math.cos(around), Math.cos(height) * Math.sin(around), Math.sin(height)).multiplyScalar(length);
    } else if (event.key === "+" || event.key === "=") away.multiplyScalar(0.92);
    else if (event.key === "-") away.multiplyScalar(1.08);
    else return;
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(away);
    this.draw();
  }
}

// A floor around the infant that shows only shadows, and lines every 10 cm that fade away.
function makeFloor() {
  const shadow = new Mesh(new CircleGeometry(1, 64), new ShadowMaterial({ opacity: 0.2, color: 0x3a2a1a }));
  shadow.receiveShadow = true;
  const material = new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: { middle: { value: new Vector2() } },
    vertexShader: "varying vec2 at; void main() { at = (modelMatrix * vec4(position, 1.0)).xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: `varying vec2 at; uniform vec2 middle;
      void main() {
        vec2 cell = abs(fract(at * 10.0 + 0.5) - 0.5) / fwidth(at * 10.0);
        float line = 1.0 - min(min(cell.x, cell.y), 1.0);
        gl_FragColor = vec4(0.35, 0.29, 0.22, 0.16 * line * smoothstep(0.85, 0.15, distance(at, middle)));
      }`,
  });
  const lines = new Mesh(new CircleGeometry(1, 64), material);
  lines.position.z = 0.0005;
  const ground = new Mesh(new CircleGeometry(30, 64), new MeshBasicMaterial({ color: 0xdfd2be }));
  ground.position.z = -0.0005;
  ground.visible = false; // But in what the eyes see.
  return { shadow, lines, ground };
}
