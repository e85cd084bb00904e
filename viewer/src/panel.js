// Sliders and their like.

export const byId = (id) => document.getElementById(id);

function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

export function heading(text) {
  return made("h2", { textContent: text });
}

/** A slider whose track runs from 0 to 1; `value` and `place` lead to the number and back. */
export function slider({ id, text, title = "", value = (at) => at, place = (x) => x, shown, onInput }) {
  const output = made("output");
  const input = made("input", { id, type: "range", min: 0, max: 1, step: 0.001 });
  input.setAttribute("aria-label", text);
  const label = made("label", { title }, made("span", { textContent: text }), input, output);
  input.addEventListener("input", () => onInput(value(Number(input.value))));
  label.show = (x) => {
    if (document.activeElement !== input || !input.matches(":active")) input.value = place(x);
    output.textContent = shown(x);
  };
  return label;
}

/** A slider over [lower, upper]. */
export function linear({ lower, upper, ...rest }) {
  return slider({ value: (at) => lower + at * (upper - lower), place: (x) => (x - lower) / (upper - lower), ...rest });
}

export function tick({ id, text, checked, onChange }) {
  const input = made("input", { id, type: "checkbox", checked });
  input.addEventListener("change", () => onChange(input.checked));
  return made("label", { className: "tick" }, input, made("span", { textContent: text }));
}

export function choice({ id, title, names, chosen, onChange }) {
  const select = made("select", { id, title }, ...names.map((name, i) => made("option", { value: i, textContent: name })));
  select.value = chosen;
  select.setAttribute("aria-label", title);
  select.addEventListener("change", () => onChange(Number(select.value)));
  return select;
}

/** Buttons of which one is pressed. */
export function oneOf(names, pressed, onPick) {
  const buttons = names.map((name, i) => made("button", { textContent: name, onclick: () => onPick(i) }));
  buttons.forEach((button, i) => button.setAttribute("aria-pressed", i === pressed));
  return row(...buttons);
}

export function button(text, onclick) {
  return made("button", { textContent: text, onclick });
}

export function row(...elements) {
  return made("div", { className: "pick" }, ...elements);
}

/** The times of the last frames, with a line where real time ends. */
export function drawGraph(canvas, lines, limit) {
  const context = canvas.getContext("2d");
  const { width, height } = canvas;
  const scale = height / Math.max(1.25 * limit, ...lines.flatMap(({ times }) => times));
  context.clearRect(0, 0, width, height);
  context.fillStyle = "#8a949e";
  context.fillRect(0, height - scale * limit, width, 1);
  for (const { times, colour } of lines) {
    context.strokeStyle = colour;
    context.lineWidth = 1.5;
    context.beginPath();
    times.forEach((time, i) => context.lineTo((i * width) / 89, height - scale * time));
    context.stroke();
  }
}
