// MuJoCo for the page's program, which pages without physics do not contain.

import loadMujoco from "@mujoco/mujoco";

globalThis.loadMujoco = loadMujoco;
