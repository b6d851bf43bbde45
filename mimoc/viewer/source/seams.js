// Normals where layers of a skin meet, or a layer its own other side: vertices at one place get the mean of their normals.

const FINENESS = 20000; // Places that are equal to half a tenth of a millimetre are one.

// Which vertices of some layers are at one place: lists of [layer, vertex], of all places with more than one.
export function findSeams(layers) {
  const places = new Map();
  layers.forEach((positions, layer) => {
    for (let vertex = 0; vertex < positions.length / 3; vertex += 1) {
      const key = [0, 1, 2].map((axis) => Math.round(FINENESS * positions[3 * vertex + axis])).join();
      const there = places.get(key);
      if (there) there.push([layer, vertex]);
      else places.set(key, [[layer, vertex]]);
    }
  });
  return [...places.values()].filter((there) => there.length > 1);
}

// Give the vertices at one place one normal, unless they face away from each other, as both sides of cloth do.
export function joinNormals(seams, normals) {
  for (const there of seams) {
    let [x, y, z] = [0, 0, 0];
    const [first, start] = there[0];
    const kept = there.filter(([layer, vertex]) => [0, 1, 2].reduce((sum, axis) => sum + normals[layer][3 * vertex + axis] * normals[first][3 * start + axis], 0) > 0);
    for (const [layer, vertex] of kept) {
      x += normals[layer][3 * vertex];
      y += normals[layer][3 * vertex + 1];
      z += normals[layer][3 * vertex + 2];
    }
    const length = Math.hypot(x, y, z) || 1;
    for (const [layer, vertex] of kept) normals[layer].set([x / length, y / length, z / length], 3 * vertex);
  }
}
