// The page starts here.

import { openApp } from "./app.js";
import { readData } from "./data.js";
import { choice, section, sentence } from "./elements.js";
import { addModes } from "./modes.js";
import { fillPanel } from "./panel.js";

async function main() {
  const data = await readData(document);
  const infants = data.infants ?? { [data.name]: data }; // One, or those of a world by name.
  const empty = document.querySelector("main").cloneNode(true);
  const open = async (name) => {
    if (window.mimoc) {
      window.mimoc.close();
      document.querySelector("main").replaceWith(empty.cloneNode(true));
    }
    const app = await openApp(infants[name], document);
    document.getElementById("name").textContent = sentence(app.data.name);
    document.getElementById("bounds").textContent = app.data.bounds;
    fillPanel(app, document);
    if (data.infants) {
      const { row, press } = choice("Infant", Object.keys(infants), open);
      press(name);
      document.getElementById("panel").prepend(section("Infant", row));
    }
    addModes(app, document);
    const hint = document.getElementById("hint");
    document.getElementById("canvas").addEventListener("pointerdown", () => (hint.style.opacity = 0), { once: true });
    app.stage.resize();
    window.mimoc = app; // For tests, and for whoever opens the console.
  };
  await open(Object.keys(infants)[0]);
}

main().catch((error) => {
  console.error(error);
  document.getElementById("message").textContent = `The page cannot be shown: ${error.message}`;
});
