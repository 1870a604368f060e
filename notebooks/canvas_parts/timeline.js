// The stacked panels with one time axis and one cursor. Curves lie on one canvas a panel; cursor and handles on a
// second one above it, so that moving the pointer never draws the curves again.

const CURSOR_HELP = "Left and right arrows move the time cursor, with Shift ten times as far, Home and End to its ends.";
const PLAY_HELP = "Space plays and Escape stops; B changes sides with what is pinned.";
const CORNER_HELP = "Square brackets choose a corner; arrows then move it, and Escape goes back to the cursor.";

const CURSOR_KEYS = { ArrowLeft: -1, ArrowRight: 1, Home: -1, End: 1 };
const TIP_ROOM = 70; // pixels that the tallest tip needs above its corner

class Timeline {
  /** `post` sends a message and returns its seq, `say` tells screen readers; without `post` nothing can be dragged. */
  constructor(root, post, say) {
    Object.assign(this, { root, post, say, panels: [], shape: "", frame: null, cursor: null, view: null, playing: false, keys: {}, onHandle: () => {}, onCursor: () => {} });
    this.handles = new Handles(post, () => this.refresh(), say);
    this.sayReading = whenQuiet(() => say(this.reading()), 500);
    this.build();
    this.boxes = null;
    this.observer = new ResizeObserver(() => {
      this.fitLegends();
      this.boxes = null;
      this.redraw();
    });
    this.observer.observe(this.stage);
    this.unwatch = watchTheme(() => {
      this.palette = null;
      this.redraw();
    });
  }

  build() {
    const help = make("span", { id: uniqueId("help"), class: "tm-unseen" }, this.post ? `${CURSOR_HELP} ${PLAY_HELP} ${CORNER_HELP}` : CURSOR_HELP);
    this.axis = make("canvas", { class: "tm-axis", "aria-hidden": true });
    this.stack = make("div", { class: "tm-stack" });
    this.stage = make(
      "div",
      {
        class: "tm-stage", tabindex: 0, role: "application", "aria-roledescription": "time line",
        "aria-label": "Traces over time", "aria-describedby": help.id, "data-lm-suppress-shortcuts": "true",
        onkeydown: (event) => this.onKey(event),
        onkeyup: (event) => ARROWS[event.key] && this.handles.release(),
        onblur: () => this.handles.release(),
      },
      this.stack, this.axis,
    );
    this.olderTag = make("div", { class: "tm-older-tag" }, "older than the text");
    this.nothing = make("p", { class: "tm-nothing", hidden: true }, "Nothing to draw yet.");
    this.tip = make("div", { class: "tm-tip", role: "tooltip", hidden: true });
    this.element = make("div", { class: "tm-timeline" }, help, this.stage, this.olderTag, this.nothing, this.tip);
    this.element.timeline = this; // for tests and measurements
  }

  /** Draws a frame at once; call it inside of requestAnimationFrame. */
  show(frame) {
    this.frame = frame;
    this.handles.take(frame);
    this.shapePanels(frame);
    this.fitRanges(frame);
    this.cursor ??= firstCursor(frame);
    this.cursor = clamp(this.cursor, frame.time.t0, frame.end);
    const empty = frame.panels.length === 0;
    this.nothing.hidden = !empty;
    this.axis.hidden = empty;
    this.olderTag.hidden = empty;
    this.drawAll();
  }

  /** Makes the elements of the panels anew only when panels or series change. */
  shapePanels(frame) {
    const look = ({ key, label, role, dash, width }) => [key, label, role, dash, width];
    const shape = JSON.stringify(frame.panels.map((panel) => [panel.key, panel.label, panel.height, panel.series.map(look)]));
    if (shape === this.shape) return;
    this.shape = shape;
    this.panels.forEach(({ plot }) => this.observer.unobserve(plot));
    this.panels = frame.panels.map((panel) => this.makePanel(panel));
    this.stack.replaceChildren(...this.panels.map((parts) => parts.element));
    this.panels.forEach(({ plot }) => this.observer.observe(plot));
    this.fitLegends();
    this.boxes = null;
  }

  /** Where plots and axis lie; asked for once a layout, since each question makes the browser lay out the whole page. */
  measureBoxes() {
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const boxOf = (element) => {
      const box = element.getBoundingClientRect();
      return { left: box.left - left, top: box.top - top, width: box.width, height: box.height };
    };
    return { whole: { width, height }, axis: boxOf(this.axis), plots: this.panels.map(({ plot }) => boxOf(plot)) };
  }

  makePanel(panel) {
    // Plain elements: an <output> is read aloud at each change, and `sayReading` says all values once the cursor rests.
    const values = panel.series.map(() => make("span", { class: "tm-value" }));
    const entries = panel.series.map((series, k) =>
      make("span", { class: "tm-entry", "data-series": series.key },
        lineSample(series.role, series.dash ?? [], Math.min(series.width, 6)), series.label, " ",
        make("span", { class: "tm-pair" }, values[k], make("span", { class: "tm-unit-text" }, panel.unit && ` ${panel.unit}`))));
    const base = make("canvas", { class: "tm-base", "aria-hidden": true });
    const over = make("canvas", { class: "tm-over", "aria-hidden": true });
    const plot = make("div", { class: "tm-plot" }, base, over);
    const title = make("span", { class: "tm-panel-title" }, panel.label);
    const legend = make("div", { class: "tm-legend" }, panel.folds ? foldOf(panel.label) : "", title, wordsOf(panel.terms), ...entries);
    const attributes = { class: "tm-panel", "data-panel": panel.key, role: "group", "aria-label": panel.label };
    const element = make("div", attributes, legend, plot);
    element.style.flexGrow = panel.height;
    const parts = { element, legend, plot, base, over, values, key: panel.key, lay: null };
    this.listen(parts);
    return parts;
  }

  /** Units stay beside the numbers where a legend fits into one row with them; they are in its title too. */
  fitLegends() {
    for (const { legend } of this.panels) {
      legend.classList.remove("tm-tight");
      legend.classList.toggle("tm-tight", legend.clientHeight > 28);
    }
  }

  /** Ranges of the axes. While a corner is pulled its own axes stand still, and the others only grow. */
  fitRanges(frame) {
    const still = this.handles.pulling && this.view;
    if (!still) this.view = { from: frame.time.t0, to: Math.max(frame.end, frame.pinned?.end ?? 0) };
    const held = still ? frame.handles[this.handles.pulled.index]?.panel : null;
    const before = this.ranges ?? new Map();
    this.ranges = new Map();
    for (const panel of frame.panels) {
      const old = before.get(panel.key);
      if (old && panel.key === held) {
        this.ranges.set(panel.key, old);
        continue;
      }
      const fresh = rangeOf(panel, frame.arrays, frame.handles);
      const grown = old && still ? { low: Math.min(old.low, fresh.low), high: Math.max(old.high, fresh.high) } : fresh;
      this.ranges.set(panel.key, grown);
    }
  }

  redraw() {
    cancelAnimationFrame(this.whole);
    this.whole = requestAnimationFrame(() => this.frame && this.drawAll());
  }

  refresh() {
    cancelAnimationFrame(this.part);
    this.part = requestAnimationFrame(() => this.frame && this.drawOver());
  }

  drawAll() {
    cancelAnimationFrame(this.part); // what it would draw is drawn here
    this.palette ??= paletteOf(this.root);
    this.boxes ??= this.measureBoxes();
    this.panels.forEach((parts, k) => {
      const surface = fitted(parts.base, this.boxes.plots[k]);
      const panel = this.frame.panels[k];
      parts.lay = null; // one that is folded has no place
      if (surface) parts.lay = drawPanel(surface, this.frame, panel, this.view, this.ranges.get(panel.key), this.palette);
    });
    this.drawOver();
  }

  drawOver() {
    this.boxes ??= this.measureBoxes();
    this.panels.forEach((parts, k) => {
      const surface = parts.lay && fitted(parts.over, this.boxes.plots[k]);
      if (!surface) return;
      this.drawCursor(surface.context, this.frame.panels[k], parts);
      this.handles.draw(surface.context, parts.key, parts.lay, this.palette);
    });
    const axis = fitted(this.axis, this.boxes.axis);
    if (axis) drawTimeAxis(axis, this.view, this.cursor, this.palette);
    this.panels.forEach((parts, k) => this.readOut(this.frame.panels[k], parts)); // texts last: they undo the layout
    this.onCursor();
    this.showTip();
  }

  drawCursor(context, panel, { lay }) {
    const across = Math.round(lay.x(this.cursor)) + 0.5;
    if (across < lay.left || across > lay.right + 1) return;
    context.setLineDash([]);
    context.lineWidth = 1;
    context.globalAlpha = 0.55;
    ruler(context, across, 0, across, lay.bottom + 6, this.palette.ink);
    context.globalAlpha = 1;
    for (const series of panel.series) {
      const value = valueAt(this.frame.arrays[series.buffer], this.frame.time, this.cursor, series.step);
      if (!Number.isFinite(value) || series.role === "target") continue;
      context.beginPath();
      context.arc(across, lay.y(value), 2.8, 0, 2 * Math.PI);
      context.fillStyle = this.palette[series.role] ?? this.palette.ink;
      context.fill();
      context.strokeStyle = this.palette.paper;
      context.stroke();
    }
  }

  readOut(panel, { values }) {
    const { low, high } = this.ranges.get(panel.key);
    const decimals = readoutDecimals(low, high, panel.digits);
    panel.series.forEach((series, k) => {
      const value = valueAt(this.frame.arrays[series.buffer], this.frame.time, this.cursor, series.step);
      setText(values[k], numberText(value, decimals));
    });
  }

  /** What the cursor reads, as a sentence. */
  reading() {
    const parts = this.panels.flatMap(({ values }, k) =>
      this.frame.panels[k].series.map((series, j) => `${series.label} ${values[j].textContent} ${this.frame.panels[k].unit}`));
    return `${this.root.hasAttribute("data-older") ? "Older than the text. " : ""}At ${numberText(this.cursor, 2)} s: ${parts.join(", ")}`;
  }

  showTip() {
    const tip = this.handles.tip();
    const handle = tip && this.frame.handles[tip.index];
    const place = handle ? this.panels.findIndex(({ key, lay }) => key === handle.panel && lay) : -1;
    if (place >= 0) this.placeTip(tip, this.panels[place].lay, this.boxes.plots[place]);
    else this.tip.hidden = true;
    this.onHandle(handle ? handle.line : 0, this.handles.pulling);
  }

  /** The tip stands on the side of its corner that has more room, so it fits whatever its own size is. */
  placeTip(tip, lay, box) {
    const { t, y } = this.handles.placeOf(tip.index);
    setText(this.tip, tip.text);
    this.tip.hidden = false;
    const { width, height } = this.boxes.whole;
    const across = clamp(box.left + lay.x(t), 0, width);
    const down = clamp(box.top + lay.y(y), 0, height);
    const [toLeft, below] = [across > width / 2, down < TIP_ROOM];
    const { style } = this.tip;
    style.left = toLeft ? "auto" : `${across + 12}px`;
    style.right = toLeft ? `${width - across + 12}px` : "auto";
    style.top = below ? `${down + 14}px` : "auto";
    style.bottom = below ? "auto" : `${height - down + 12}px`;
  }

  moveCursor(t) {
    this.cursor = clamp(t, this.view.from, this.view.to);
    this.refresh();
  }

  listen(parts) {
    const { over } = parts;
    over.addEventListener("pointermove", (event) => this.onPointer(event, parts));
    over.addEventListener("pointerdown", (event) => this.onDown(event, parts));
    over.addEventListener("pointerleave", () => this.handles.hover(-1));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      over.addEventListener(name, (event) => event.isPrimary && this.handles.release());
    }
  }

  onPointer(event, { lay, key, over }) {
    if (!lay || !event.isPrimary) return; // a second finger moves nothing
    const [t, y] = [lay.x.back(event.offsetX), lay.y.back(event.offsetY)];
    if (over.hasPointerCapture(event.pointerId)) this.handles.pull(t, y);
    else {
      const index = this.handles.nearest(key, lay, event.offsetX, event.offsetY);
      this.handles.hover(index);
      over.style.cursor = pointerOver(this.handles.list[index]);
    }
    if (!this.playing) this.moveCursor(t);
  }

  onDown(event, { lay, key, over }) {
    if (!lay || event.button !== 0 || !event.isPrimary) return;
    const index = this.handles.nearest(key, lay, event.offsetX, event.offsetY);
    if (index < 0) {
      this.handles.chosen = -1;
      this.moveCursor(lay.x.back(event.offsetX));
      return;
    }
    if (this.handles.grab(index, lay.x.back(event.offsetX), lay.y.back(event.offsetY))) {
      over.setPointerCapture(event.pointerId);
    }
  }

  onKey(event) {
    const command = commandOf(event);
    if (command) this.onCommand(command, event);
    if (!this.frame || event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.byKey(event.key, event.shiftKey)) event.preventDefault();
  }

  /** A drag is undone where it was made. */
  onCommand(command, event) {
    if (this.post) {
      event.preventDefault();
      this.post({ type: command });
    }
    if (command === "save") passOn(event, this.element);
  }

  /** Does what a key asks for; false if it asks for nothing here. */
  byKey(key, tenfold) {
    this.sayReading.cancel();
    if (this.keys[key.length > 1 ? key : key.toLowerCase()]?.()) return true;
    if (CURSOR_KEYS[key] && this.playing) this.keys.Escape?.();
    if (key === "[" || key === "]") this.handles.choose(key === "]" ? 1 : -1);
    else if (key === "Escape" && this.handles.chosen >= 0) {
      this.handles.chosen = -1;
      this.refresh();
    } else if (this.handles.nudge(key, tenfold)) return true;
    else if (CURSOR_KEYS[key]) {
      const far = key === "Home" || key === "End" ? Infinity : (tenfold ? 10 : 1) * KEY_STEPS.t;
      this.moveCursor(this.cursor + CURSOR_KEYS[key] * far);
      this.sayReading();
    } else return false;
    return true;
  }

  stop() {
    this.observer.disconnect();
    this.unwatch();
    this.sayReading.cancel();
    cancelAnimationFrame(this.whole);
    cancelAnimationFrame(this.part);
  }
}

/** Shows and hides the plot of its panel, whose legend still reads it out; the stage's observer draws anew. */
function foldOf(label) {
  const fold = make("button", { type: "button", class: "tm-fold", "aria-label": `plot of ${label}`, "aria-expanded": "true" });
  fold.addEventListener("click", () => {
    const folded = fold.closest(".tm-panel").classList.toggle("tm-folded");
    fold.setAttribute("aria-expanded", String(!folded));
  });
  fold.addEventListener("keydown", (event) => event.stopPropagation());
  return fold;
}

/** A "?" whose tooltip says what words mean, and which opens to a list of them; nothing where there are none. */
function wordsOf(terms) {
  if (!terms?.length) return "";
  const lines = terms.flatMap(([word, meaning]) => [make("dt", {}, word), make("dd", {}, meaning)]);
  const title = terms.map(([word, meaning]) => `${word}: ${meaning}`).join("\n");
  const name = `what ${terms.map(([word]) => word).join(", ")} mean`;
  const details = make("details", { class: "tm-words" }, make("summary", { title, "aria-label": name }, "?"), make("dl", {}, ...lines));
  details.addEventListener("focusout", () => (details.open = false));
  details.addEventListener("keydown", (event) => event.stopPropagation());
  return details;
}

/** Where the cursor is at first: at the first mark, else at a quarter of the time. */
function firstCursor(frame) {
  const marks = frame.panels.flatMap((panel) => panel.marks);
  return marks.length ? Math.min(...marks.map((mark) => mark.t)) : frame.time.t0 + (frame.end - frame.time.t0) / 4;
}

function drawTimeAxis({ context, width }, view, cursor, palette) {
  const x = linear(view.from, view.to, GUTTER, width - MARGIN);
  const { step, at } = ticksOf(view.from, view.to, timeTicks(x.end - x.start));
  const said = `${numberText(cursor, 2)} s`;
  context.font = `${FONT_PX}px ${palette.font}`;
  context.textBaseline = "middle";
  context.textAlign = "center";
  context.fillStyle = palette.soft;
  const half = context.measureText(said).width / 2 + 6;
  const middle = clamp(x(cursor), half, width - half - 1);
  for (const t of at) {
    const text = `${numberText(t, tickDecimals(step))} s`;
    const own = context.measureText(text).width / 2;
    const across = clamp(x(t), own, width - own - 1);
    if (Math.abs(across - middle) > own + half + 1) context.fillText(text, across, 11);
  }
  context.fillStyle = palette.ink;
  context.beginPath();
  context.roundRect(middle - half, 2, 2 * half, 18, 3);
  context.fill();
  context.fillStyle = palette.paper;
  context.fillText(said, middle, 11.5);
}
