// What the page knows: plain data in which arrays stand as {values, shape, unit}; see packing.py.

const KINDS = { f4: Float32Array, i2: Int16Array, u4: Uint32Array, u1: Uint8Array };

export async function readData(document) {
  const text = (id) => document.getElementById(id).textContent;
  const { arrays, ...data } = JSON.parse(text("data"));
  const { buffer } = await unzip(bytesOf(text("block")));
  return withArrays(data, arrays.map((each) => arrayOf(buffer, each)));
}

export function bytesOf(base64) {
  return Uint8Array.from(atob(base64.trim()), (letter) => letter.charCodeAt(0));
}

export async function unzip(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function arrayOf(buffer, { at, kind, shape }) {
  const count = shape.reduce((product, size) => product * size, 1);
  return { values: new KINDS[kind](buffer, at, count), shape };
}

function withArrays(value, arrays) {
  if (Array.isArray(value)) return value.map((each) => withArrays(each, arrays));
  if (value === null || typeof value !== "object") return value;
  if ("array" in value) return value.unit ? { ...placesOf(arrays[value.array]), unit: value.unit } : { ...arrays[value.array], unit: 1 };
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, withArrays(each, arrays)]));
}

// Places by age, from the steps between ages: their low and then their high bytes, by age, axis and place.
function placesOf({ values, shape: [, ages, axes, count] }) {
  const places = new Int16Array(ages * count * axes);
  for (let from = 0; from < places.length; from += 1) {
    const to = (Math.floor(from / (axes * count)) * count + (from % count)) * axes + (Math.floor(from / count) % axes);
    const step = values[from] | (values[places.length + from] << 8);
    places[to] = step + (to < axes * count ? 0 : places[to - axes * count]); // Of more than 16 bits, the others are lost.
  }
  return { values: places, shape: [ages, count, axes] };
}
