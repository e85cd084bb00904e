// node play_in_node.mjs PLAYER.mjs CHARACTER.glb POSES FRAMES [CLOTH]: plays poses, (T, D) float64, with the player of
// `doublet view`: reset() in the first, cloth not settled, a step to each other. FRAMES gets surface, high and body of every
// frame, float64. CLOTH: states of the cloth before each step, (T - 1, ...) as setCloth() takes them. Prints ms of the steps.

import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [player, character, poses, frames, cloth] = process.argv.slice(2);
const { Simulation } = await import(pathToFileURL(player));
const simulation = await Simulation.open(new Uint8Array(readFileSync(character)), 0);
const numbers = (path) => new Float64Array(new Uint8Array(readFileSync(path)).buffer);
const all = numbers(poses);
const states = cloth && numbers(cloth);
const size = 6 * simulation.clothVertexCount;
const count = all.length / simulation.dofCount;
const played = [];
const times = [];
for (let t = 0; t < count; ++t) {
  const pose = all.slice(t * simulation.dofCount, (t + 1) * simulation.dofCount);
  if (states && t > 0) simulation.setCloth(states.slice((t - 1) * size, t * size));
  const start = performance.now();
  if (t === 0) simulation.reset(pose);
  else simulation.step(pose);
  if (t > 0) times.push(performance.now() - start);
  for (const name of ["surface", "high", "body"]) played.push(Buffer.from(simulation.frame(name).buffer));
}
writeFileSync(frames, Buffer.concat(played));
console.log(JSON.stringify(times));
