// Expressions: the face goes from one to another in a moment, by offsets of vertices of the skin.

import { Ages } from "./ages.js";

const SECONDS = 0.3;

export class Face {
  // `shapes`: which vertices of a layer of the skin move, how far with each expression by age, and with which one the
  // skin of the page has been made; none if only pictures change.
  constructor(shapes, shown) {
    this.shapes = shapes;
    this.ages = shapes && new Ages(shapes.ages_months);
    this.shares = new Map([[shown, 1]]); // Of each expression that is not quite gone.
    this.wanted = shown;
  }

  get moves() {
    return Boolean(this.shapes);
  }

  show(name) {
    this.wanted = name;
    if (!this.shares.has(name)) this.shares.set(name, 0);
  }

  // Go on for some seconds; returns whether it has arrived.
  advance(seconds) {
    const step = this.moves ? seconds / SECONDS : 1;
    for (const [name, share] of this.shares) {
      const now = Math.min(Math.max(share + (name === this.wanted ? step : -step), 0), 1);
      if (now || name === this.wanted) this.shares.set(name, now);
      else this.shares.delete(name);
    }
    return this.shares.size === 1 && this.shares.get(this.wanted) === 1;
  }

  // Let the expressions move the vertices of a layer at an age.
  deform(layer, age, positions) {
    if (this.shapes?.layer !== layer) return;
    this.#move(this.shapes.begins, -1, age, positions);
    for (const [name, share] of this.shares) this.#move(name, share * share * (3 - 2 * share), age, positions);
  }

  #move(name, share, age, positions) {
    const { moving, moves } = this.shapes;
    if (!moves[name]) return; // As of the neutral face.
    const offsets = this.ages.blend(moves[name], age);
    moving.values.forEach((vertex, i) => {
      for (let axis = 0; axis < 3; axis += 1) positions[3 * vertex + axis] += share * offsets[3 * i + axis];
    });
  }
}
