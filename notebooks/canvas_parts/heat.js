// The heat view: matrices side by side as grids of cells, so that each cell can be read, focused and clicked.

const SMALLEST_FOR_NUMBERS = 23;

class HeatView {
  constructor(root, flow, say) {
    Object.assign(this, { root, flow, say, shape: "", focused: [0, 0], pointed: null, cells: [] });
    this.maps = make("div", { class: "tm-maps" });
    this.reading = make("div", { class: "tm-reading" }, "\u00a0");
    this.element = make("div", { class: "tm-heat" }, this.maps, this.reading);
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(this.maps);
    this.unwatch = watchTheme(() => requestAnimationFrame(() => this.ink()));
  }

  show(frame) {
    this.frame = frame;
    const shape = JSON.stringify([frame.labels, frame.matrices.map(({ key, label }) => [key, label])]);
    if (shape !== this.shape) this.build(shape);
    frame.matrices.forEach((matrix, k) => this.fill(matrix, k));
    this.maps.querySelectorAll(".tm-rough").forEach((mark) => setText(mark, frame.rough));
    this.outline(frame.picked);
    this.point(this.pointed); // its numbers may be new
    this.fit();
  }

  build(shape) {
    Object.assign(this, { shape, pointed: null });
    const [row, column] = this.focused;
    const last = this.frame.labels.length - 1;
    this.focused = [Math.min(row, last), Math.min(column, last)];
    this.cells = this.frame.matrices.map(() => []);
    this.maps.replaceChildren(...this.frame.matrices.map((matrix, k) => this.makeMap(matrix, k)));
  }

  makeMap(matrix, k) {
    const { labels } = this.frame;
    const common = commonStart(labels);
    const corner = make("span", { role: "columnheader", class: "tm-corner", title: common && `every name begins with ${common}` }, common && `${common}…`);
    const own = (name) => endsKept(name.slice(common.length));
    const heads = labels.map((name, j) =>
      make("span", { role: "columnheader", class: "tm-column", "data-column": j, title: name, "aria-label": name }, make("span", {}, own(name))));
    const rows = labels.map((name, i) => {
      const cells = labels.map((_, j) => this.makeCell(k, i, j));
      this.cells[k].push(cells);
      const head = make("span", { role: "rowheader", class: "tm-row", "data-row": i, title: name, "aria-label": name }, own(name));
      return make("div", { role: "row", class: "tm-grid-row" }, head, ...cells);
    });
    const grid = make(
      "div",
      { role: "grid", class: "tm-grid", "aria-label": matrix.label, "data-lm-suppress-shortcuts": "true", onkeydown: (event) => this.onKey(event, k), onpointerleave: () => this.point(null) },
      make("div", { role: "row", class: "tm-grid-row tm-grid-head" }, corner, ...heads),
      ...rows,
    );
    grid.style.setProperty("--tm-count", labels.length);
    grid.style.setProperty("--tm-label", `${clamp(7 * Math.max(common.length + 1, ...labels.map((name) => own(name).length)) + 8, 40, 150)}px`);
    return make("figure", { class: "tm-map", "data-matrix": matrix.key }, make("figcaption", {}, matrix.label, " ", wordsOf(matrix.terms), " ", make("span", { class: "tm-rough" })), grid, this.scaleOf(matrix));
  }

  makeCell(k, row, column) {
    return make("button", {
      type: "button", role: "gridcell", class: "tm-cell", "data-row": row, "data-column": column, tabindex: -1,
      onclick: () => this.pick(row, column),
      onfocus: () => this.focusOn(row, column),
      onpointerenter: () => this.point([row, column]),
    });
  }

  scaleOf(matrix) {
    return make("div", { class: "tm-scale", "aria-hidden": true },
      make("span", {}, cellText(matrix.low, matrix)), make("span", { class: "tm-ramp" }), make("span", {}, cellText(matrix.high, matrix)));
  }

  fill(matrix, k) {
    const values = this.frame.arrays[matrix.buffer];
    const { labels } = this.frame;
    this.cells[k].forEach((cells, i) => cells.forEach((cell, j) => {
      const value = values[i * labels.length + j];
      const part = clamp((value - matrix.low) / (matrix.high - matrix.low || 1), 0, 1);
      const text = cellText(value, matrix);
      setText(cell, text);
      cell.style.setProperty("--tm-part", Number.isFinite(part) ? part.toFixed(3) : 0);
      cell.setAttribute("aria-label", `${labels[i]}, ${labels[j]}: ${text}`);
      cell.tabIndex = i === this.focused[0] && j === this.focused[1] ? 0 : -1;
    }));
    const longest = Math.max(...this.cells[k].flat().map((cell) => cell.textContent.length));
    this.maps.children[k].dataset.longest = longest;
  }

  /** Numbers stay away where cells are too small for them; the reading below has them anyway. */
  fit() {
    for (const map of this.maps.children) {
      const wide = map.querySelector(".tm-cell")?.clientWidth ?? 0;
      const few = wide >= Math.max(SMALLEST_FOR_NUMBERS, 6.1 * map.dataset.longest);
      map.classList.toggle("tm-no-numbers", !few || this.frame?.labels.length > 16);
    }
    this.ink();
  }

  /** Numbers are black or white, whichever stands out more from what the theme makes of their cell. */
  ink() {
    if (this.frame?.labels.length > 16) return;
    const light = new Map();
    for (const cell of this.cells.flat(2)) {
      const ground = getComputedStyle(cell).backgroundColor;
      if (!light.has(ground)) light.set(ground, luminance(ground) > 0.179); // equal contrast to both
      cell.classList.toggle("tm-black", light.get(ground));
      cell.classList.toggle("tm-white", !light.get(ground));
    }
  }

  both(row, column) {
    return this.cells.map((cells) => cells[row]?.[column]).filter(Boolean);
  }

  outline(picked) {
    this.maps.querySelectorAll(".tm-picked").forEach((cell) => {
      cell.classList.remove("tm-picked");
      cell.removeAttribute("aria-selected");
    });
    if (!picked) return;
    for (const cell of this.both(...picked)) {
      cell.classList.add("tm-picked");
      cell.setAttribute("aria-selected", "true");
    }
  }

  /** Names the pair under the pointer or focus, with all its numbers, and lifts its labels. */
  point(pair) {
    this.pointed = pair;
    this.maps.querySelectorAll(".tm-pointed").forEach((element) => element.classList.remove("tm-pointed"));
    if (!pair) return setText(this.reading, this.frame.picked ? this.readPair(...this.frame.picked) : "\u00a0");
    const [row, column] = pair;
    const places = `.tm-row[data-row="${row}"], .tm-column[data-column="${column}"], .tm-cell[data-row="${row}"][data-column="${column}"]`;
    this.maps.querySelectorAll(places).forEach((element) => element.classList.add("tm-pointed"));
    setText(this.reading, this.readPair(row, column));
  }

  readPair(row, column) {
    const { labels, matrices, arrays } = this.frame;
    const numbers = matrices.map((matrix) => `${matrix.label} ${cellText(arrays[matrix.buffer][row * labels.length + column], matrix)}`);
    const pairText = row === column ? labels[row] : `${labels[row]} \u2192 ${labels[column]}`;
    return `${pairText}: ${numbers.join(", ")}`;
  }

  focusOn(row, column) {
    for (const cell of this.both(...this.focused)) cell.tabIndex = -1;
    this.focused = [row, column];
    for (const cell of this.both(row, column)) cell.tabIndex = 0;
    this.point([row, column]);
  }

  pick(row, column) {
    this.outline([row, column]); // at once; the frame that answers says it again
    this.flow.post({ type: "cell", row, column });
  }

  onKey(event, k) {
    const ways = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0], Home: [0, -Infinity], End: [0, Infinity] };
    const way = ways[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const last = this.frame.labels.length - 1;
    const [row, column] = this.focused.map((at, axis) => clamp(at + way[axis], 0, last));
    this.cells[k][row][column].focus();
  }

  stop() {
    this.observer.disconnect();
    this.unwatch();
  }
}

/** A name with its beginning and its end, which tells the icons of a set apart most often. */
function endsKept(name, most = 16) {
  return name.length > most ? `${name.slice(0, most / 2 - 1)}…${name.slice(-most / 2)}` : name;
}

/** What all names of a set begin with, up to a sign between words; it is said once. Nothing where it is short. */
function commonStart(names) {
  const least = names.reduce((common, name) => common.slice(0, commonHead(common, name)), names[0] ?? "");
  const start = /^.*[-_=.]/.exec(least)?.[0] ?? "";
  return names.length > 1 && start.length > 3 ? start : "";
}

/** A value as its matrix writes it: "0.0" or "0%". */
function cellText(value, matrix) {
  if (!Number.isFinite(value)) return "–";
  const decimals = (/\.(0+)/.exec(matrix.text ?? "0.0")?.[1] ?? "").length;
  if (!(matrix.text ?? "").includes("%")) return `${numberText(value, decimals)}${matrix.unit ?? ""}`;
  return `${numberText(100 * value, decimals)}%`;
}

function heatFrame(meta, buffers) {
  const defaults = { seq: 0, labels: [], matrices: [], picked: null, rough: "", ms: null };
  return { ...defaults, ...meta, arrays: (buffers ?? []).map(floatsOf) };
}
