// A character on the page: its worker, and the frames that have come from it.

import workerSource from "worker.bundle.js"; // text, see build.mjs

const AHEAD = 3; // frames that are asked for before they are needed
const REMEMBERED = 90; // times of frames

export class Actor {
  /** @param {{name: string, glb: Uint8Array}} character */
  constructor(character, clips, onProblem) {
    this.name = character.name;
    this.clips = clips; // of this character's skeleton
    this.times = []; // ms of the last steps
    this.asking = new Map(); // ticket -> what waits for a clip
    this.frames = new Map(); // number -> {drawn}
    this.run = 0; // frames of an earlier run are not wanted any more
    this.onProblem = onProblem;
    this.address = URL.createObjectURL(new Blob([workerSource], { type: "text/javascript" }));
    this.worker = new Worker(this.address);
    this.opened = new Promise((resolve, reject) => Object.assign(this, { onOpened: resolve, onRefused: reject }));
    this.worker.onmessage = ({ data }) => this[`on_${data.type}`](data);
    this.worker.onerror = (event) => onProblem(event.message);
    this.worker.postMessage({ type: "open", character: character.glb });
  }

  on_opened(message) {
    URL.revokeObjectURL(this.address);
    this.dt = message.dt;
    this.clothVertexCount = message.clothVertexCount;
    this.materials = message.materials;
    this.estimated = message.materials.map((material) => [...material]);
    this.onOpened(message);
  }
  on_clip({ ticket, poses, text }) {
    const { resolve, reject } = this.asking.get(ticket);
    this.asking.delete(ticket);
    if (poses) resolve(poses);
    else reject(new Error(text));
  }
  on_materials({ materials }) {
    this.materials = materials;
  }
  on_problem({ text, run }) {
    this.onRefused(new Error(text)); // of one that is open nobody waits for that
    if (run === undefined || run === this.run) this.onProblem(text);
  }
  on_frame({ run, how, milliseconds, drawn }) {
    if (run !== this.run) return;
    this.frames.set(this.arrived++, drawn);
    if (how === "step") this.times = [...this.times, milliseconds].slice(-REMEMBERED);
  }

  /** @param schedule which pose of the clip each frame has; frame 0 begins anew */
  begin(clip, schedule) {
    this.poses = this.clips[clip];
    this.schedule = schedule;
    this.run += 1;
    this.asked = this.arrived = 0;
    this.frames.clear();
  }

  /** Asks for the frames up to a few beyond number `next`; forgets those before number `shown`. */
  ask(shown, next) {
    for (const number of this.frames.keys()) if (number < shown) this.frames.delete(number);
    for (; this.asked < Math.min(this.schedule.length, next + AHEAD); this.asked += 1) {
      const at = this.schedule[this.asked];
      const isJump = this.asked > 0 && at === 0 && this.schedule[this.asked - 1] !== 0;
      const how = this.asked === 0 || (isJump && this.begun !== at) ? "reset" : isJump ? "beginAgain" : "step";
      if (how === "reset") this.begun = at; // the pose for which the cloth is kept
      this.worker.postMessage({ type: "frame", how, run: this.run, pose: this.poses[at] });
    }
  }

  /** Poses of a clip's file, or of turning to and fro if there is none. */
  posesOf({ fileName, bytes }) {
    const ticket = (this.tickets = (this.tickets ?? 0) + 1);
    this.worker.postMessage({ type: "clip", ticket, name: fileName, bytes });
    return new Promise((resolve, reject) => this.asking.set(ticket, { resolve, reject }));
  }
  setMaterial(region, parameter, value) {
    this.worker.postMessage({ type: "material", region, parameter, value });
  }
  setWind(value) {
    this.worker.postMessage({ type: "wind", value });
  }
  setGravity(value) {
    this.worker.postMessage({ type: "gravity", value });
  }

  /** ms a simulated frame, mean of the last ones; NaN before the first. */
  get milliseconds() {
    return this.times.reduce((sum, time) => sum + time, 0) / this.times.length;
  }

  end() {
    URL.revokeObjectURL(this.address);
    this.worker.terminate();
  }
}
