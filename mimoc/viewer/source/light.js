// The light: a sun with soft shadows, the sky, and a floor that shows where the sky is hidden from it.

import { BufferGeometry, CircleGeometry, DataTexture, DirectionalLight, Float32BufferAttribute, HemisphereLight, LineBasicMaterial, LinearFilter, LineSegments, MathUtils, Mesh, MeshBasicMaterial, PlaneGeometry, ShaderChunk, ShadowMaterial, Vector3 } from "three";

const SUN = new Vector3(1.2, 0.9, 2.4); // Where it is, from the infant.
const SHADOWS = { pixels: 1024, soft: 7, spread: "2.6", taps: "14" }; // Softer on the floor, which is farther from what casts them.
const CELL = 0.1; // Metres between the lines on the floor.
const GRID = 96; // Points of the floor along each side, where what is hidden of the sky is computed.
const LOW = 0.1; // Metres above the floor within which bodies darken it.
const DEEPEST = 165; // Of 255: how dark the floor gets under a body.

// Shadows are the mean of more places than usual, on a disc that each pixel turns by some angle of its own.
ShaderChunk.shadowmap_pars_fragment = ShaderChunk.shadowmap_pars_fragment.replace(
  /shadow = \(\s*texture\([^]*?\) \* 0\.2;/,
  `shadow = 0.0;
  for (int tap = 0; tap < ${SHADOWS.taps}; tap += 1) shadow += texture(shadowMap, vec3(shadowCoord.xy + vogelDiskSample(tap, ${SHADOWS.taps}, phi) * radius * SPREAD, shadowCoord.z));
  shadow /= ${SHADOWS.taps}.0;`,
);
ShaderChunk.common += "\n#ifndef SPREAD\n#define SPREAD 1.0\n#endif\n";

export class Light {
  constructor(scene) {
    this.sun = new DirectionalLight(0xfff4e6, 1.7);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(SHADOWS.pixels, SHADOWS.pixels);
    this.sun.shadow.radius = SHADOWS.soft;
    this.sun.shadow.normalBias = 0.009;
    const window = new DirectionalLight(0xfff6ee, 0.55);
    window.position.set(2, -0.6, 0.7);
    const sky = new HemisphereLight(0xfffdfa, 0xd9bfa2, 1.65);
    sky.position.set(0, 0, 1);
    scene.add(this.sun, this.sun.target, window, sky);
    this.reach = 1.25; // How far shadows are drawn, by the radius of the infant.
    this.floor = new Floor();
    scene.add(...this.floor.parts);
  }

  // Let the shadows of a ball be drawn.
  aim(middle, radius) {
    const { camera } = this.sun.shadow;
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).add(SUN);
    const [right, reach] = [1.6 * radius, this.reach * radius];
    Object.assign(camera, { left: -right, right, top: right, bottom: -right, near: 0.3, far: 6 });
    camera.updateProjectionMatrix();
    this.floor.aim(middle, reach);
  }
}

// A floor around the infant that shows only shadows, and faint lines every 10 cm that fade away.
class Floor {
  constructor() {
    this.shadow = new Mesh(new CircleGeometry(1, 64), new ShadowMaterial({ opacity: 0.17, color: 0x3a2a1a }));
    this.shadow.material.defines = { SPREAD: SHADOWS.spread };
    this.shadow.receiveShadow = true;
    this.hidden = new Uint8Array(4 * GRID * GRID).fill(0); // From the sky, as the opacity of a dark picture.
    this.picture = new DataTexture(this.hidden, GRID, GRID);
    this.picture.magFilter = LinearFilter;
    this.contact = new Mesh(new PlaneGeometry(2, 2), new MeshBasicMaterial({ color: 0x49321f, alphaMap: this.picture, transparent: true, depthWrite: false }));
    this.lines = makeLines();
    this.ground = new Mesh(new CircleGeometry(30, 64), new MeshBasicMaterial({ color: 0xdfd2be }));
    this.ground.visible = false; // But in what the eyes see.
    this.parts = [this.ground, this.contact, this.shadow, this.lines];
    this.parts.forEach((part, layer) => {
      part.position.z = 0.0002 * (layer - 1);
      part.renderOrder = layer - 4;
    });
  }

  aim(middle, reach) {
    this.shadow.position.set(middle.x - (SUN.x * middle.z) / SUN.z, middle.y - (SUN.y * middle.z) / SUN.z, this.shadow.position.z);
    this.shadow.scale.setScalar(reach);
    this.contact.position.set(middle.x, middle.y, this.contact.position.z);
    this.contact.scale.setScalar(reach);
    this.lines.position.set(CELL * Math.round(middle.x / CELL), CELL * Math.round(middle.y / CELL), this.lines.position.z);
  }

  // Darken the floor under balls, [x, y, z, radius, x ...]: by the share of the sky that they hide.
  darken(balls) {
    const { position, scale } = this.contact;
    const low = lowOnes(balls);
    for (let row = 0, at = 1; row < GRID; row += 1) {
      const up = (2 * row + 1) / GRID - 1;
      for (let column = 0; column < GRID; column += 1, at += 4) {
        const right = (2 * column + 1) / GRID - 1;
        const share = hiddenFrom(position.x + scale.x * right, position.y + scale.x * up, low);
        this.hidden[at] = DEEPEST * (1 - Math.exp(-share)) * MathUtils.smoothstep(1 - Math.hypot(right, up), 0, 0.4);
      }
    }
    this.picture.needsUpdate = true;
  }
}

// The balls that darken the floor: x, y, square of the height, and how much, one after another.
function lowOnes(balls) {
  const low = [];
  for (let i = 0; i < balls.length; i += 4) {
    const [x, y, radius] = [balls[i], balls[i + 1], balls[i + 3]];
    const z = Math.max(balls[i + 2], radius);
    if (z - radius < 4 * LOW) low.push(x, y, z * z, radius * radius * z * Math.exp((radius - z) / LOW));
  }
  return Float64Array.from(low);
}

// The share of the sky that they hide from a place on the floor.
function hiddenFrom(x, y, low) {
  let share = 0;
  for (let i = 0; i < low.length; i += 4) {
    const [dx, dy] = [low[i] - x, low[i + 1] - y];
    const square = dx * dx + dy * dy + low[i + 2];
    share += low[i + 3] / (square * Math.sqrt(square));
  }
  return share;
}

// Lines, as they cover far fewer pixels than a floor with a pattern.
function makeLines() {
  const [points, colours] = [[], []];
  const put = (x, y) => {
    points.push(x, y, 0);
    colours.push(0.35, 0.29, 0.22, 0.09 * MathUtils.smoothstep(0.75 - Math.hypot(x, y), 0, 0.6));
  };
  for (let line = -8; line <= 8; line += 1) {
    for (let part = -16; part < 16; part += 1) {
      const [across, from, to] = [line * CELL, (part * CELL) / 2, ((part + 1) * CELL) / 2];
      for (const along of [from, to]) put(across, along);
      for (const along of [from, to]) put(along, across);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 4));
  return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
}
