// A character of the page, simulated beside the page's own thread.

import { Simulation, SURFACES } from "./simulation.js";

let simulation;
const todo = {
  async open({ character }) {
    simulation = await Simulation.open(character);
    const { dt, texture, bodyColour, clothVertexCount } = simulation;
    const shapes = SURFACES.map((_, which) => simulation.shape(which));
    postMessage({ type: "opened", dt, texture, bodyColour, clothVertexCount, shapes, materials: simulation.materials });
  },
  /** how: "reset", "beginAgain" or "step". */
  frame({ how, pose, run }) {
    const start = performance.now();
    simulation[how](pose);
    if (how === "beginAgain") simulation.step(pose);
    const milliseconds = performance.now() - start;
    const drawn = simulation.drawn();
    const lent = drawn.flatMap(({ positions, normals }) => [positions.buffer, normals.buffer]);
    postMessage({ type: "frame", run, how, milliseconds, drawn }, lent);
  },
  /** A dropped file becomes poses; without a file the character turns to and fro. */
  clip({ ticket, name, bytes }) {
    try {
      const poses = bytes ? simulation.retarget(name, bytes) : simulation.turning(4, 0.9 * Math.PI);
      postMessage({ type: "clip", ticket, poses });
    } catch (error) {
      postMessage({ type: "clip", ticket, text: error.message });
    }
  },
  material({ region, parameter, value }) {
    simulation.setMaterial(region, parameter, value);
    postMessage({ type: "materials", materials: simulation.materials });
  },
  wind({ value }) {
    simulation.setWind(value);
  },
  gravity({ value }) {
    simulation.setGravity(value);
  },
};

let last = Promise.resolve(); // messages are done in the order in which they came
onmessage = ({ data }) => {
  const complain = (error) => postMessage({ type: "problem", run: data.run, text: error.message });
  last = last.then(() => todo[data.type](data)).catch(complain);
};
