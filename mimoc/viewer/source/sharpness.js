// How sharp pictures are: less so while something moves and they would come too slowly, and as sharp as can be at rest.

const SHARES = [1, 0.75, 0.5]; // Of the pixels along each side.
const [SLOW, QUICK] = [45, 22]; // Milliseconds for a picture, above which they get coarser, and below which finer again.
const PATIENCE = 30; // Quick pictures before they get finer.
const LEAST = 0.5; // Pixels per pixel of the page.

export class Sharpness {
  // `quick`: whether a graphics card draws. Without one, edges are smoothed only at rest, by more pixels.
  constructor(quick) {
    this.quick = quick;
    this.level = 0;
    this.#start();
  }

  #start() {
    this.mean = (SLOW + QUICK) / 2;
    this.pictures = 0;
  }

  // A picture came so many milliseconds after it was asked for.
  tell(milliseconds) {
    this.mean += 0.3 * (milliseconds - this.mean);
    this.pictures += 1;
    const step = this.mean > SLOW ? 1 : this.mean < QUICK && this.pictures > PATIENCE ? -1 : 0;
    if (!step || !(this.level + step in SHARES)) return;
    this.level += step;
    this.#start();
  }

  get resting() {
    return this.quick ? Math.min(window.devicePixelRatio, 2) : 2;
  }

  get moving() {
    const most = this.quick ? this.resting : Math.min(window.devicePixelRatio, 1);
    return Math.max(most * SHARES[this.level], LEAST);
  }
}

// Whether a graphics card draws, by the browser's own judgement.
export function drawsQuickly() {
  const context = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}
