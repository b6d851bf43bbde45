// The page starts here.

import { openApp } from "./app.js";
import { readData } from "./data.js";
import { sentence } from "./elements.js";
import { addModes } from "./modes.js";
import { fillPanel } from "./panel.js";

async function main() {
  const app = await openApp(await readData(document), document);
  document.getElementById("name").textContent = sentence(app.data.name);
  fillPanel(app, document);
  addModes(app, document);
  const hint = document.getElementById("hint");
  document.getElementById("canvas").addEventListener("pointerdown", () => (hint.style.opacity = 0), { once: true });
  app.stage.resize();
  window.mimoc = app; // For tests, and for whoever opens the console.
}

main().catch((error) => {
  console.error(error);
  document.getElementById("message").textContent = `The page cannot be shown: ${error.message}`;
});
