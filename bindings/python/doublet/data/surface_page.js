"use strict";
// What the pages share on which a user paints on a surface: the view of it, picking, the brush, undo, saving.
//
// open_surface(data, tools): data has vertices (3 V) m and faces (3 F). tools: `modes` (ids of buttons, the first is chosen), `keys`
// (key -> id of the button that it presses), `colour(face, corner)` in [0, 1]^3, `paint(hit, mode)`, which changes what is under the
// brush and returns how to take that back (null: nothing changed), `drawing()` and `shown()` before and after each drawing, `saved_at` and `sent()`, which are
// posted, and `told(answer)`, what to say then.
const $ = id => document.getElementById(id), canvas = $("view"), gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
const eye = { turn: 0, tilt: 0, distance: 3, target: [0, 0, 0] };   // rad about +Y from +Z, rad above the horizon, m
const FIELD = 0.6;                                                  // tan of half the height of view
let faces, corners, normals, colours, tools, mode, saved = true, drag = null, undo = [], stroke = null;

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]], dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const along = (a, s, b) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const say = (text, bad) => { $("status").textContent = text; $("status").className = bad ? "bad" : ""; };
const brush_radius = () => $("radius").value / 1000;                // m

function camera() {
  const [ct, st, ce, se] = [Math.cos(eye.turn), Math.sin(eye.turn), Math.cos(eye.tilt), Math.sin(eye.tilt)];
  const back = [st * ce, se, ct * ce], right = [ct, 0, -st], up = cross(back, right);
  return { back, right, up, at: along(eye.target, eye.distance, back) };
}

function program() {
  const compile = (kind, text) => { const s = gl.createShader(kind); gl.shaderSource(s, text); gl.compileShader(s); return s; };
  const p = gl.createProgram();
  gl.attachShader(p, compile(gl.VERTEX_SHADER, `attribute vec3 corner, normal, colour; uniform mat4 clip; uniform vec3 light; varying vec3 shown;
    void main() { gl_Position = clip * vec4(corner, 1.0); shown = colour * (0.45 + 0.55 * max(dot(normal, light), 0.0)); }`));
  gl.attachShader(p, compile(gl.FRAGMENT_SHADER, `precision mediump float; varying vec3 shown; void main() { gl_FragColor = vec4(shown, 1.0); }`));
  gl.linkProgram(p);
  gl.useProgram(p);
  gl.enable(gl.DEPTH_TEST);
  return p;
}

let shader, buffers = {}, waiting = false;
function upload(name, data) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name] ||= gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  const place = gl.getAttribLocation(shader, name);
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
}

/// The surface with its vertices (3 V) elsewhere.
function place(vertices) {
  for (let f = 0; f < faces.length / 3; ++f) {
    const points = [0, 1, 2].map(k => { const v = 3 * faces[3 * f + k]; return [vertices[v], vertices[v + 1], vertices[v + 2]]; });
    const n = cross(sub(points[1], points[0]), sub(points[2], points[0])), length = Math.hypot(...n) || 1;
    points.forEach((p, k) => { corners.set(p, 9 * f + 3 * k); normals.set(n.map(v => v / length), 9 * f + 3 * k); });
  }
  upload("corner", corners);
  upload("normal", normals);
  draw();
}

function draw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    const w = canvas.width = canvas.clientWidth * devicePixelRatio, h = canvas.height = canvas.clientHeight * devicePixelRatio;
    gl.viewport(0, 0, w, h);
    gl.clearColor(0.957, 0.957, 0.949, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { back, right, up, at } = camera(), near = eye.distance / 100, far = eye.distance * 10, a = (far + near) / (far - near), b = 2 * far * near / (far - near);
    const x = right.map(v => v * h / w / FIELD), y = up.map(v => v / FIELD), z = back.map(v => -a * v), u = back.map(v => -v);
    gl.uniformMatrix4fv(gl.getUniformLocation(shader, "clip"), false, new Float32Array([
      x[0], y[0], z[0], u[0], x[1], y[1], z[1], u[1], x[2], y[2], z[2], u[2], -dot(x, at), -dot(y, at), -dot(z, at) - b, -dot(u, at)]));
    const light = along(along(back, 0.4, up), 0.3, right), length = Math.hypot(...light);
    gl.uniform3fv(gl.getUniformLocation(shader, "light"), light.map(v => v / length));
    tools.drawing();
    for (let f = 0; f < faces.length / 3; ++f)
      for (let k = 0; k < 3; ++k) colours.set(tools.colour(f, k), 9 * f + 3 * k);
    upload("colour", colours);
    gl.drawArrays(gl.TRIANGLES, 0, faces.length);
    tools.shown();
  });
}

/// The nearest triangle under the mouse, seen from outside or inside, and the point on it (Moeller & Trumbore 1997); null beside the surface.
function pick(event) {
  const { back, right, up, at } = camera(), box = canvas.getBoundingClientRect();
  const sx = (2 * (event.clientX - box.left) / box.width - 1) * FIELD * box.width / box.height, sy = (1 - 2 * (event.clientY - box.top) / box.height) * FIELD;
  const way = along(along(back.map(v => -v), sx, right), sy, up);
  let best = null;
  for (let f = 0; f < faces.length / 3; ++f) {
    const [p, q, r] = [0, 3, 6].map(k => corners.subarray(9 * f + k, 9 * f + k + 3)), e1 = sub(q, p), e2 = sub(r, p), n = cross(way, e2), det = dot(e1, n);
    if (Math.abs(det) < 1e-14) continue;
    const from = sub(at, p), u = dot(from, n) / det, m = cross(from, e1), v = dot(way, m) / det, s = dot(e2, m) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && s > 0 && (!best || s < best.s)) best = { s, face: f, point: along(at, s, way) };
  }
  return best;
}

/// What is joined to `start` by `neighbours` within the brush around a point: not what lies behind. at(i) is the place of i.
function under_brush(start, neighbours, at, point) {
  const seen = new Set(start), todo = [...start];
  while (todo.length)
    for (const g of neighbours[todo.pop()])
      if (!seen.has(g) && Math.hypot(...sub(at(g), point)) <= brush_radius()) { seen.add(g); todo.push(g); }
  return seen;
}

/// Sets values[i] for all i of `chosen`; returns how to take that back, null if nothing changed.
function assign(values, chosen, value) {
  const before = [...chosen].filter(i => values[i] !== value).map(i => [i, values[i]]);
  for (const [i] of before) values[i] = value;
  return before.length ? () => { for (const [i, old] of before) values[i] = old; } : null;
}

/// Does what `change` does, and keeps how to take it back.
function change_all(change) {
  const back = change();
  if (back) { undo.push([back]); saved = false; }
  draw();
}

function take_back() {
  const last = undo.pop();
  if (!last) return say("Nothing to undo.");
  for (const back of last.reverse()) back();
  saved = false;
  say("");
  draw();
}

async function save() {
  say("Saving ...");
  const sent = tools.sent();
  try {
    const token = document.querySelector("meta[name=token]").content;
    const headers = { "Content-Type": "application/json", "X-Page-Token": token };
    const answer = await fetch(tools.saved_at, { method: "POST", headers, body: sent });
    const told = await answer.json();
    if (!answer.ok) throw new Error(told.error);
    saved = sent === tools.sent();
    say(tools.told(told));
  } catch (error) { say("Not saved: " + error.message, true); }
  draw();
}

function choose(id) {
  mode = id;
  for (const other of tools.modes) $(other).className = other === id ? "on" : "";
}

function paint_at(event) {
  const hit = pick(event), back = hit && tools.paint(hit, mode);
  if (back) { stroke.push(back); saved = false; draw(); }
  return hit;
}

function listen() {
  canvas.oncontextmenu = event => event.preventDefault();
  canvas.onpointerdown = event => {
    canvas.setPointerCapture(event.pointerId);
    stroke = [];
    const hit = event.button === 0 && !event.altKey && !event.shiftKey && paint_at(event);
    drag = { kind: hit ? "brush" : event.button === 1 || event.shiftKey ? "move" : "turn", x: event.clientX, y: event.clientY };
  };
  canvas.onpointermove = event => {
    if (!drag) return;
    const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
    [drag.x, drag.y] = [event.clientX, event.clientY];
    if (drag.kind === "brush") return paint_at(event);
    if (drag.kind === "turn") {
      eye.turn -= 0.008 * dx;
      eye.tilt = Math.max(-1.57, Math.min(1.57, eye.tilt + 0.008 * dy));
    } else {
      const { right, up } = camera(), scale = 2 * FIELD * eye.distance / canvas.clientHeight;
      eye.target = along(along(eye.target, -dx * scale, right), dy * scale, up);
    }
    draw();
  };
  canvas.onpointerup = canvas.onpointercancel = () => {
    if (drag && stroke.length) undo.push(stroke);
    drag = stroke = null;
  };
  canvas.addEventListener("wheel", event => { event.preventDefault(); eye.distance *= Math.exp(0.001 * event.deltaY); draw(); }, { passive: false });
  for (const id of tools.modes) $(id).onclick = () => choose(id);
  $("undo").onclick = take_back;
  $("save").onclick = save;
  $("radius").oninput = () => { $("radiusText").textContent = $("radius").value + " mm"; };
  for (const button of document.querySelectorAll("[data-turn]"))
    button.onclick = () => { [eye.turn, eye.tilt] = button.dataset.turn.split(" ").map(Number); draw(); };
  onkeydown = event => {
    const of_browser = event.ctrlKey || event.metaKey || event.altKey; // Ctrl+A chooses nothing of ours
    const key = event.key.toLowerCase(), pressed = { z: "undo", s: "save", ...(of_browser ? {} : tools.keys) }[key];
    if (pressed) { event.preventDefault(); $(pressed).click(); }
    if (key === "[" || key === "]") { $("radius").value = +$("radius").value + (key === "]" ? 3 : -3); $("radius").oninput(); }
  };
  onresize = draw;
  onbeforeunload = event => { if (!saved) event.preventDefault(); };
}

function open_surface(data, with_tools) {
  [tools, faces] = [with_tools, data.faces];
  [corners, normals, colours] = [1, 2, 3].map(() => new Float32Array(3 * faces.length));
  const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
  data.vertices.forEach((v, i) => { low[i % 3] = Math.min(low[i % 3], v); high[i % 3] = Math.max(high[i % 3], v); });
  eye.target = low.map((v, axis) => (v + high[axis]) / 2);
  eye.distance = 0.6 * Math.hypot(...sub(high, low)) / FIELD;
  shader = program();
  place(data.vertices);
  listen();
  choose(tools.modes[0]);
  $("radius").oninput();
  say("Ready.");
}

/// `show(data)` with what is at `address`; says what goes wrong.
async function start(address, show) {
  try {
    if (!gl) throw new Error("This browser has no WebGL.");
    show(await (await fetch(address)).json());
  } catch (error) { say(String(error), true); }
}
