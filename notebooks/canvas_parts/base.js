// Small helpers that all parts use. The parts stand in one module: canvas.py joins them, so nothing is imported.

/** Makes an element: make("button", {class: "x", onclick: f}, "text", child). */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true && !name.startsWith("aria-") ? "" : value); // an empty aria-hidden hides nothing
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** A short horizontal line as SVG, whose colour follows the theme by itself. */
function lineSample(role, dash, width) {
  const space = "http://www.w3.org/2000/svg";
  const picture = document.createElementNS(space, "svg");
  picture.setAttribute("class", "tm-sample");
  picture.setAttribute("viewBox", "0 0 26 10");
  picture.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(space, "line");
  const lie = { x1: 0, x2: 26, y1: 5, y2: 5, "stroke-width": width, "stroke-dasharray": dash.join(" ") };
  for (const [name, value] of Object.entries(lie)) line.setAttribute(name, value);
  line.style.stroke = `var(--tm-${role})`;
  picture.append(line);
  return picture;
}

function clamp(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/** A number for people: fixed decimals, a true minus sign, and no "−0.0". */
function numberText(value, decimals) {
  if (!Number.isFinite(value)) return "–";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

/** Sets text only when it changed, so that screen readers and layout are left alone otherwise. */
function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** The unit in a label such as "temperature (°C)"; "" without one. */
function unitOf(label) {
  const found = /\(([^()]*)\)/.exec(label);
  return found ? found[1] : "";
}

/** What the workbench does at a keystroke in text and time line: "undo", "redo", "save", or null. */
function commandOf(event) {
  if (event.isComposing || !(event.ctrlKey || event.metaKey) || event.altKey) return null;
  const key = event.key.toLowerCase();
  if (key === "z") return event.shiftKey ? "redo" : "undo";
  return { y: "redo", s: "save" }[key] ?? null;
}

/** A keystroke for the notebook around, outside of JupyterLab for nobody. */
function passOn(event, element) {
  const outside = element.closest(".tm-root")?.parentElement;
  if (!outside?.closest(".jp-Notebook")) return;
  event.preventDefault();
  const { key, code, keyCode, ctrlKey, metaKey, shiftKey } = event;
  outside.dispatchEvent(new KeyboardEvent("keydown", { key, code, keyCode, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true }));
}

let uniqueCount = 0;
function uniqueId(stem) {
  uniqueCount += 1;
  return `tm-${stem}-${uniqueCount}-${Math.random().toString(36).slice(2, 8)}`;
}

/** Calls `act` once things have been quiet for `ms`. */
function whenQuiet(act, ms) {
  let timer = 0;
  const later = (...given) => {
    clearTimeout(timer);
    timer = setTimeout(() => act(...given), ms);
  };
  later.cancel = () => clearTimeout(timer);
  return later;
}
