// The page of `doublet view`: one character, or two, that dance to the same clip.

import { Actor } from "./actor.js";
import { bytesOf, posesOf } from "./data.js";
import { button, byId, choice, drawGraph, heading, linear, oneOf, row, slider, tick } from "./panel.js";
import { acceptFiles, isCharacter, save } from "./files.js";
import { Stage } from "./stage.js";

const COLOURS = ["#a5423b", "#33658a"];
const SETTLING = "The cloth falls into place";
const SPEEDS = [1, 0.5, 0.25, 0.1];
const PLAIN_NAMES = {
  d_n: "air drag",
  d_t: "drag along",
  k_bend: "bending",
  k_stretch: "stretching",
  k_friction: "friction",
  k_damping: "damping",
};
const STANDARD_GRAVITY = 9.81;
const LONGEST_PAUSE = 0.1; // s between two pictures that the clock makes up for
const TOO_SLOW = 45; // ms a picture, mean of ...
const PATIENCE = 10; // ... so many

/** What goes wrong before anything is shown is said, too. */
function orSay(make) {
  try {
    return make();
  } catch (error) {
    say(error.message, true);
    throw error;
  }
}

const data = orSay(() => {
  if (!window.DOUBLET_VIEW) throw new Error("expected data.js beside index.html, as `doublet view` wrote it");
  return window.DOUBLET_VIEW;
});
const characters = data.characters.map(({ name, glb }) => ({ name, glb: bytesOf(glb) }));
// poses: of each character; those of a dropped file come when a character is there that wants them
const clips = data.clips.map(({ name, poses }) => ({ name, poses: poses.map((of, i) => posesOf(of, data.characters[i].dofs)) }));

const stage = orSay(() => new Stage(byId("stage"))); // needs WebGL 2
const state = {
  actors: [], // {actor, figure}
  clip: 0,
  playing: true,
  holds: false, // the pose; the cloth goes on
  speed: 1,
  time: 0, // frames since the beginning, with their fraction
  schedule: [0], // which pose of the clip each frame has
  wind: { speed: 0, from: 0 }, // m/s, degrees
  gravity: STANDARD_GRAVITY,
  chosen: 0, // the actor whose material the sliders show ...
  region: 0, // ... and its piece of cloth
  follows: true,
  pictures: [], // ms of the last pictures
};

function say(text, isProblem = false) {
  byId("status").textContent = text;
  byId("status").classList.toggle("problem", isProblem);
}

async function addActor(which) {
  say("Loading");
  const character = characters[which];
  const actor = new Actor(character, clips.map((clip) => clip.poses[which]), (text) => say(text, true));
  try {
    const opened = await actor.opened;
    for (const clip of clips) clip.poses[which] ??= await actor.posesOf(clip);
    actor.clips = clips.map((clip) => clip.poses[which]);
    actor.which = which;
    state.actors.push({ actor, figure: await stage.addFigure(opened) });
  } catch (error) {
    actor.end();
    throw error;
  }
  setWorld();
}

/** At a pose of the clip, in which the cloth falls into place. */
function begin(at = 0) {
  say(SETTLING);
  state.time = 0;
  state.schedule = [at];
  for (const { actor } of state.actors) actor.begin(state.clip, state.schedule);
}

function setWorld() {
  const angle = (state.wind.from * Math.PI) / 180;
  const { speed } = state.wind;
  for (const { actor } of state.actors) {
    actor.setWind([-speed * Math.sin(angle), 0, -speed * Math.cos(angle)]);
    actor.setGravity([0, -state.gravity, 0]);
  }
}

// --- every picture

let lastTime;
let isNew = true;
let notice = ""; // about the character that is new

/** Until now there was nothing to draw: the page was loading, or behind another one. */
function wake() {
  lastTime = performance.now();
}

function advance(seconds) {
  if (state.actors.length === 0) return false; // between two characters
  const [{ actor: first }] = state.actors;
  const count = clips[state.clip].poses[first.which].length;
  const here = Math.floor(state.time);
  while (state.schedule.length < here + 8) {
    const last = state.schedule.at(-1);
    state.schedule.push(state.holds ? last : (last + 1) % count);
  }
  for (const { actor } of state.actors) actor.ask(here, here + 1);
  const arrived = Math.min(...state.actors.map(({ actor }) => actor.arrived));
  if (arrived < 2) return false;
  if (state.playing) state.time = Math.min(state.time + (Math.min(seconds, LONGEST_PAUSE) * state.speed) / first.dt, arrived - 1);
  return true;
}

function show() {
  const here = Math.floor(state.time);
  const ends = state.schedule[here + 1] === 0 && !state.holds; // a jump to the first pose
  for (const { actor, figure } of state.actors) {
    const before = actor.frames.get(here);
    const after = (!ends && actor.frames.get(here + 1)) || before;
    if (before) figure.show(before, after, state.time - here);
  }
}

function picture(now) {
  requestAnimationFrame(picture);
  const seconds = (now - lastTime) / 1000;
  const before = state.time;
  lastTime = now;
  const isReady = advance(seconds);
  if (isReady) {
    show();
    if (isNew) {
      say(notice, notice !== "");
      notice = "";
      stage.resize();
      stage.home();
      isNew = false;
    }
    if (byId("status").textContent === SETTLING) say("");
    if (state.follows) stage.follow(seconds);
  }
  stage.draw(isReady && state.time !== before);
  watchTheClock(1000 * seconds);
}

function watchTheClock(milliseconds) {
  state.pictures = [...state.pictures, milliseconds].slice(-60);
  if (state.pictures.length < PATIENCE || mean(state.pictures) < TOO_SLOW || !state.playing) return;
  stage.lighten();
  state.pictures = [];
}

const mean = (numbers) => numbers.reduce((sum, number) => sum + number, 0) / numbers.length;

function showNumbers() {
  if (state.actors.length === 0) return;
  const steps = state.actors.map(({ actor }) => actor).filter((actor) => actor.times.length > 0);
  if (steps.length > 0) {
    const each = steps.map((actor) => `${actor.milliseconds.toFixed(1)} ms`).join(" and ");
    const slowest = Math.max(...steps.map((actor) => actor.milliseconds));
    byId("simulated").textContent = `${each}, ${Math.round(1000 / slowest)} fps`;
    const lines = steps.map(({ times }, i) => ({ times, colour: COLOURS[i] }));
    drawGraph(byId("graph"), lines, 1000 * steps[0].dt);
  }
  if (state.pictures.length > 0) {
    const time = mean(state.pictures);
    byId("drawn").textContent = `${time.toFixed(1)} ms, ${Math.round(1000 / time)} fps`;
  }
  for (const label of sliders) label.refresh();
  showTime();
  const labels = byId("labels").children;
  state.actors.forEach(({ figure }, i) => {
    if (!labels[i] || !figure.extent) return;
    const { x, y } = stage.above(figure);
    labels[i].style.left = `${x}px`;
    labels[i].style.top = `${y}px`;
  });
}

// --- the panel

let sliders = [];

/** k_stretch matters close to 1 alone. */
const NEAR_ONE = { value: (at) => 1 - Math.pow(1 - at, 4) * 0.999, place: (x) => 1 - Math.pow((1 - x) / 0.999, 0.25) };

function materialSlider({ name, lower, upper, unit, meaning }, parameter) {
  const make = name === "k_stretch" ? (options) => slider({ ...options, ...NEAR_ONE }) : linear;
  const label = make({
    id: name,
    text: PLAIN_NAMES[name] ? `${PLAIN_NAMES[name]} ${name}` : name,
    title: `${name}: ${meaning}`,
    lower,
    upper,
    shown: (x) => `${name === "k_stretch" ? x.toFixed(5) : x.toFixed(3)} ${unit}`,
    onInput: (x) => chosenActor().setMaterial(state.region, parameter, x),
  });
  label.refresh = () => label.show(chosenActor().materials[state.region][parameter]);
  return label;
}

function worldSlider(options, get, set) {
  const label = linear({ ...options, onInput: (x) => (set(x), setWorld()) });
  label.refresh = () => label.show(get());
  return label;
}

const chosenActor = () => state.actors[state.chosen].actor;

function chooseClip(i) {
  state.clip = i;
  begin();
}

function chooseRegion(i) {
  state.region = i;
}

function choose(i) {
  state.region = 0;
  state.chosen = i;
  byId("controls").classList.toggle("of-second", i === 1);
}

/** The panel is of the one that is chosen: it may have more cloth than the other, or none. */
function pick(i) {
  choose(i);
  fillPanel();
  byId("controls").querySelector("[aria-pressed=true]").focus();
}

function forgetMaterial() {
  const { estimated } = chosenActor();
  estimated[state.region].forEach((value, parameter) => chosenActor().setMaterial(state.region, parameter, value));
}

/** As material.json: `doublet edit-character --material-file` takes it. */
function saveMaterial() {
  const { name, materials } = chosenActor();
  const regions = materials.map((values) => ({ parameters: Object.fromEntries(data.parameters.map((p, i) => [p.name, values[i]])) }));
  save(`${name}-material.json`, `${JSON.stringify({ regions }, null, 1)}\n`);
}

// --- files that are dropped

async function takeFile(fileName, bytes) {
  if (/\.(png|jpe?g)$/i.test(fileName)) {
    await state.actors[state.chosen].figure.setTexture(bytes).catch((error) => {
      throw new Error(`${fileName}: ${error.message}`);
    });
  } else if (isCharacter(bytes)) {
    await takeCharacter(fileName, bytes);
  } else if (/\.(bvh|fbx|glb|vrm|vrma)$/i.test(fileName)) {
    await takeClip(fileName, bytes);
  } else {
    throw new Error(`${fileName}: expected a .bvh, .fbx, .glb, .vrm, .vrma, .png or .jpg`);
  }
}

async function takeClip(fileName, bytes) {
  say(`Reading ${fileName}`);
  const clip = { name: fileName.replace(/\.[^.]*$/, ""), fileName, bytes, poses: [] };
  for (const { actor } of state.actors) clip.poses[actor.which] ??= await actor.posesOf(clip);
  clips.push(clip);
  for (const { actor } of state.actors) actor.clips.push(clip.poses[actor.which]);
  state.clip = clips.length - 1;
  fillPanel();
  begin();
}

/** In the place of all that are shown. Clips that were retargeted before the page was written are of the other skeleton; those
 *  that it cannot dance go, too. */
async function takeCharacter(fileName, glb) {
  const dropped = { name: fileName.replace(/\.[^.]*$/, ""), glb };
  const trial = new Actor(dropped, [], (text) => say(text, true));
  say(`Reading ${fileName}`);
  const fitting = [];
  const problems = [];
  try {
    await trial.opened;
    for (const clip of clips.filter(({ bytes }) => bytes)) {
      try {
        fitting.push({ ...clip, poses: [await trial.posesOf(clip)] });
      } catch (error) {
        problems.push(`${clip.name}: ${error.message.replace(/^\//, "")}`);
      }
    }
  } finally {
    trial.end();
  }
  notice = problems.join("; ");
  for (const { actor, figure } of state.actors.splice(0)) {
    actor.end();
    stage.removeFigure(figure);
  }
  characters.splice(0, characters.length, dropped);
  clips.splice(0, clips.length, ...(fitting.length ? fitting : [{ name: "to and fro", poses: [] }]));
  state.clip = 0;
  choose(0);
  await addActor(0);
  fillPanel();
  isNew = true;
  begin();
}

// --- keys, time

function onKey(event) {
  if (event.code !== "Space" || event.target.matches("select, button, input[type=checkbox]")) return;
  event.preventDefault();
  togglePlay();
}

function showTime() {
  const slider = byId("timeline");
  const [{ actor } = {}] = state.actors;
  if (!actor) return;
  const at = state.schedule[Math.min(Math.floor(state.time), state.schedule.length - 1)];
  slider.max = clips[state.clip].poses[actor.which].length - 1;
  if (!slider.matches(":active")) slider.value = at;
  slider.nextElementSibling.textContent = `${(at * (actor.dt ?? 0)).toFixed(1)} s`;
}

async function compare(isTwo) {
  byId("compare").disabled = true; // until the second one is there
  if (isTwo) {
    try {
      await addActor(characters.length - 1);
    } catch (error) {
      say(error.message.replace(/^\//, ""), true); // it cannot dance a clip that was dropped
      return fillPanel();
    }
  } else {
    const { actor, figure } = state.actors.pop();
    actor.end();
    stage.removeFigure(figure);
    choose(0);
  }
  fillPanel();
  isNew = true;
  begin();
}

const CALLED = ["first", "second"];
/** Names of the characters, or their places if they are the same. */
function called() {
  const names = state.actors.map(({ actor }) => actor.name);
  return new Set(names).size === names.length ? names : CALLED;
}

function fillPanel() {
  const controls = byId("controls");
  const two = state.actors.length > 1;
  const regions = chosenActor().materials.map((_, i) => `cloth ${i + 1}`);
  const materials = regions.length > 0 ? data.parameters.map(materialSlider) : [];
  const world = [
    worldSlider({ id: "wind", text: "wind", lower: 0, upper: 15, shown: (x) => `${x.toFixed(1)} m/s` }, () => state.wind.speed,
      (x) => (state.wind.speed = x)),
    worldSlider({ id: "wind_from", text: "from", title: "0 = the front", lower: -180, upper: 180, shown: (x) => `${x.toFixed(0)}°` },
      () => state.wind.from, (x) => (state.wind.from = x)),
    worldSlider({ id: "gravity", text: "gravity", lower: 0, upper: 20, shown: (x) => `${x.toFixed(2)} m/s²` },
      () => state.gravity, (x) => (state.gravity = x)),
  ];
  sliders = [...materials, ...world];
  controls.replaceChildren(
    row(
      choice({ id: "clip", title: "Clip", names: clips.map(({ name }) => name), chosen: state.clip, onChange: chooseClip }),
      choice({ id: "speed", title: "Speed", names: SPEEDS.map((x) => `${x} × speed`), chosen: SPEEDS.indexOf(state.speed),
        onChange: (i) => (state.speed = SPEEDS[i]) }),
    ),
    tick({ id: "hold", text: "hold the pose; the cloth goes on", checked: state.holds, onChange: (on) => hold(on) }),
    tick({ id: "follow", text: "the camera goes along", checked: state.follows, onChange: (on) => (state.follows = on) }),
    tick({ id: "compare", text: "a second one beside", checked: two, onChange: compare }),
    heading("Material"),
    ...(two ? [oneOf(called(), state.chosen, pick)] : []),
    ...(regions.length > 1
      ? [row(choice({ id: "region", title: "Cloth", names: regions, chosen: state.region, onChange: chooseRegion }))]
      : []),
    ...materials,
    ...(regions.length > 0 ? [row(button("As estimated", forgetMaterial), button("Save material", saveMaterial))] : []),
    heading("World"),
    ...world,
  );
  byId("name").textContent = [...new Set(state.actors.map(({ actor }) => actor.name))].join(", ");
  byId("labels").replaceChildren(
    ...(two ? called() : []).map((name) => Object.assign(document.createElement("span"), { textContent: name })),
  );
}

/** From the frame after those that are under way. */
function hold(on) {
  state.holds = on;
  state.schedule.length = Math.max(...state.actors.map(({ actor }) => actor.asked));
}

function togglePlay() {
  state.playing = !state.playing;
  byId("play").textContent = state.playing ? "Pause" : "Play";
}

function fold() {
  byId("fold").setAttribute("aria-expanded", !byId("panel").classList.toggle("folded"));
  stage.resize();
  stage.home();
}

async function main() {
  await addActor(0);
  if (characters.length > 1) await addActor(1);
  document.title = `doublet: ${characters.map(({ name }) => name).join(", ")}`;
  fillPanel();
  if (innerWidth <= 640) fold();
  byId("play").onclick = togglePlay;
  byId("reset").onclick = () => begin();
  byId("timeline").onchange = ({ target }) => begin(Number(target.value));
  addEventListener("keydown", onKey);
  acceptFiles(document.body, takeFile, (text) => say(text, true));
  byId("home").onclick = () => stage.home();
  byId("fold").onclick = fold;
  stage.resize();
  begin();
  wake();
  document.addEventListener("visibilitychange", wake);
  requestAnimationFrame(picture);
  setInterval(showNumbers, 100);
}

main().catch((error) => say(error.message, true));
window.doubletView = { state, stage }; // for those who want to know more than the page shows
