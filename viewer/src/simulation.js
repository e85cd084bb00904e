// The player in WebAssembly as an object: a character's bytes and poses in, what is drawn out.

import createModule from "player.mjs";
import wasm from "player.wasm";

/** In the order of doublet::pbd::Material. */
export const PARAMETERS = ["d_n", "d_t", "k_bend", "k_stretch", "k_friction", "k_damping"];
/** What is drawn of a character, in the order of player.cpp. */
export const SURFACES = ["surface", "body"];

export class Simulation {
  /**
   * @param {Uint8Array} character bytes of a character.glb
   * @param {number} settleSeconds for which the cloth falls into place in reset()
   */
  static async open(character, settleSeconds = 1) {
    const module = await createModule({ wasmBinary: wasm, locateFile: (name) => name });
    return new Simulation(module, character, settleSeconds);
  }

  constructor(module, character, settleSeconds) {
    this.module = module;
    this.withFile("character.glb", character, (path) => module._player_open(path, settleSeconds));
    this.dt = module._player_dt();
    this.dofCount = module._player_dof_count();
    this.regionCount = module._player_region_count();
    this.clothVertexCount = module._player_cloth_vertex_count();
  }

  attempt(done) {
    if (!done) throw new Error(this.module.UTF8ToString(this.module._player_problem()));
  }

  /** Calls with the address of the name of a file of these bytes. */
  withFile(name, bytes, call) {
    const { FS } = this.module;
    FS.writeFile(`/${name}`, bytes);
    const text = new TextEncoder().encode(`/${name}\0`);
    const path = this.module._malloc(text.length);
    this.module.HEAPU8.set(text, path);
    const done = call(path);
    this.module._free(path);
    FS.unlink(`/${name}`);
    this.attempt(done);
  }
  /** @returns {Float64Array[]} the poses of a clip, .bvh, .fbx or .glb, retargeted to the character at its own rate */
  retarget(name, bytes) {
    const m = this.module;
    this.withFile(name, bytes, m._clip_open);
    const count = m._clip_frame_count();
    const all = this.copied(Float64Array, m._clip_poses(), count * this.dofCount);
    return Array.from({ length: count }, (_, t) => all.slice(t * this.dofCount, (t + 1) * this.dofCount));
  }
  /** Of an actor who turns to and fro on the spot, for so many seconds each way. @returns {Float64Array[]} */
  turning(seconds, angle) {
    const count = Math.round((2 * seconds) / this.dt);
    const dof = this.module._player_turning_dof();
    return Array.from({ length: count }, (_, t) => {
      const pose = new Float64Array(this.dofCount);
      if (dof >= 0) pose[dof] = angle * Math.sin((2 * Math.PI * t) / count) ** 3;
      return pose;
    });
  }

  /** Calls with the address of a copy of `numbers`. */
  withNumbers(call, numbers, expected, what) {
    if (numbers.length !== expected) throw new Error(`expected ${what} of ${expected} numbers, found ${numbers.length}`);
    const address = this.module._malloc(numbers.byteLength);
    this.module.HEAPU8.set(new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength), address);
    const done = call(address);
    this.module._free(address);
    this.attempt(done);
  }
  withPose(call, dofs) {
    this.withNumbers(call, dofs, this.dofCount, "a pose");
  }
  /** Begins anew: the cloth falls into place. @param {Float64Array} dofs */
  reset(dofs) {
    this.withPose(this.module._player_reset, dofs);
  }
  /** Back to where the last reset() ended. */
  beginAgain(dofs) {
    this.withPose(this.module._player_begin_again, dofs);
  }
  /** @param {Float64Array} values of each cloth region in turn its positions (N * 3), m, and velocities, m/s */
  setCloth(values) {
    this.withNumbers(this.module._player_set_cloth, values, 6 * this.clothVertexCount, "a state of the cloth");
  }
  /** One frame of `dt` seconds. @param {Float64Array} dofs */
  step(dofs) {
    this.withPose(this.module._player_step, dofs);
  }

  /** Of a cloth region: [region][parameter]. */
  get materials() {
    const regions = Array.from({ length: this.regionCount }, (_, region) => region);
    return regions.map((region) => PARAMETERS.map((_, parameter) => this.module._player_material(region, parameter)));
  }
  setMaterial(region, parameter, value) {
    this.attempt(this.module._player_set_material(region, parameter, value));
  }
  setWind([x, y, z]) {
    this.attempt(this.module._player_set_wind(x, y, z));
  }
  setGravity([x, y, z]) {
    this.attempt(this.module._player_set_gravity(x, y, z));
  }

  copied(Type, address, count) {
    const memory = this.module.HEAPU8;
    return new Type(memory.buffer.slice(address, address + count * Type.BYTES_PER_ELEMENT));
  }
  /** What stays of a drawn surface. */
  shape(which) {
    const m = this.module;
    return {
      triangles: this.copied(Uint32Array, m._drawn_triangles(which), 3 * m._drawn_triangle_count(which)),
      texcoords: this.copied(Float32Array, m._drawn_texcoords(which), 2 * m._drawn_vertex_count(which)),
    };
  }
  /** What moves of both: [surface, body]. */
  drawn() {
    const m = this.module;
    m._drawn_update();
    return SURFACES.map((_, which) => {
      const count = 3 * m._drawn_vertex_count(which);
      return {
        positions: this.copied(Float32Array, m._drawn_positions(which), count),
        normals: this.copied(Float32Array, m._drawn_normals(which), count),
      };
    });
  }
  /** The image file of the texture, empty if there is none. */
  get texture() {
    return this.copied(Uint8Array, this.module._texture(), this.module._texture_bytes());
  }
  /** Linear RGB. */
  get bodyColour() {
    return [0, 1, 2].map((channel) => this.module._body_colour(channel));
  }
  /** The frame as doublet::Player has it, (rows * 3) m: "surface", "high" or "body". */
  frame(name) {
    const m = this.module;
    return this.copied(Float64Array, m[`_frame_${name}`](), 3 * m[`_frame_${name}_rows`]());
  }
}
