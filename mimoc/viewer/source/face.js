// Expressions: the face goes from one to another in a moment, by offsets of vertices of some layers of the skin.

import { Ages } from "./ages.js";

const SECONDS = 0.3;

export class Face {
  // `shapes`: ages, and for each layer the offsets of its vertices by expression; none if only pictures change.
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

  // Add what the expressions move to the vertices of a layer at an age.
  deform(layer, age, positions) {
    const offsets = this.shapes?.layers[layer];
    if (!offsets) return;
    for (const [name, share] of this.shares) {
      if (!offsets[name]) continue;
      const moved = this.ages.blend(offsets[name], age);
      const eased = share * share * (3 - 2 * share);
      for (let i = 0; i < moved.length; i += 1) positions[i] += eased * moved[i];
    }
  }
}
