// The corner points that can be dragged: which one is chosen, where it is pulled to, how it looks.

const REACH_PX = 13;
const KEY_STEPS = { t: 0.05, temperature: 0.1, current: 0.01 };
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

class Handles {
  /** `post` sends a message and returns its seq; `redraw` asks for the overlay; `say` tells screen readers. */
  constructor(post, redraw, say) {
    Object.assign(this, { post, redraw, say, list: [], chosen: -1, hovered: -1, pulled: null, hint: "" });
  }

  /** Takes the handles of a frame; a finished pull is let go once its answer is there. */
  take(frame) {
    this.list = frame.handles;
    this.start = frame.time.t0;
    if (frame.icon !== this.icon && !this.pulled) Object.assign(this, { chosen: -1, hint: "" });
    this.icon = frame.icon;
    if (this.pulled?.done && frame.seq >= this.pulled.done) this.pulled = null;
    if (this.pulled && !this.list[this.pulled.index]) this.pulled = null;
    for (const pointer of ["chosen", "hovered"]) if (this[pointer] >= this.list.length) this[pointer] = -1;
  }

  get pulling() {
    return this.pulled !== null;
  }

  /** Whether a pull goes on that the answer to message `seq` does not end. */
  pulledBeyond(seq) {
    return this.pulling && !(this.pulled.done && seq >= this.pulled.done);
  }

  /** Where a handle is now: where it is pulled to, else where the kernel says. */
  placeOf(index) {
    const handle = this.list[index];
    return this.pulled?.index === index ? this.pulled : handle;
  }

  /** The handle of a panel that is nearest to a point in pixels, or -1; movable ones win over the others. */
  nearest(panel, lay, across, down) {
    let best = -1;
    let least = REACH_PX;
    this.list.forEach((handle, index) => {
      if (handle.panel !== panel) return;
      const away = Math.hypot(lay.x(handle.t) - across, lay.y(handle.y) - down);
      const far = movable(handle) ? away : away + 3;
      if (far < least) [best, least] = [index, far];
    });
    return best;
  }

  hover(index) {
    if (index === this.hovered) return;
    Object.assign(this, { hovered: index, hint: "" });
    this.redraw();
  }

  /** Begins a pull by pointer; false if this handle cannot be moved. */
  grab(index, t, y) {
    const handle = this.list[index];
    Object.assign(this, { chosen: index, hint: "" });
    this.redraw();
    if (!movable(handle)) {
      this.say(handle.why ?? "This corner does not move.");
      return false;
    }
    this.pulled = { index, t: handle.t, y: handle.y, off: [t - handle.t, y - handle.y], done: 0 };
    return true;
  }

  pull(t, y) {
    if (!this.pulled || this.pulled.done) return;
    this.moveTo(t - this.pulled.off[0], y - this.pulled.off[1]);
  }

  moveTo(t, y) {
    const handle = this.list[this.pulled.index];
    if (handle.moves_time) this.pulled.t = Math.max(this.start, t);
    if (handle.moves_level) this.pulled.y = y;
    this.tell(false);
  }

  /** Ends a pull: together with what went before it is one step of undo. */
  release() {
    if (!this.pulled || this.pulled.done) return;
    this.pulled.done = this.tell(true);
    this.say(this.described(this.pulled.index));
  }

  tell(end) {
    const { index, t, y } = this.pulled;
    this.redraw();
    return this.post({ type: "drag", handle: index, t: Number(t.toFixed(4)), y: Number(y.toFixed(4)), end });
  }

  /** Chooses the next handle (`by` 1) or the one before (-1). */
  choose(by) {
    const count = this.list.length;
    if (!count) return this.say("There is no corner to drag.");
    this.chosen = this.chosen < 0 ? (by > 0 ? 0 : count - 1) : (this.chosen + by + count) % count;
    this.byKeys("");
    this.say(this.described(this.chosen));
  }

  /** With keys the tip belongs to the chosen handle, wherever the pointer was left; `hint` says what a key cannot do. */
  byKeys(hint) {
    Object.assign(this, { hovered: -1, hint });
    this.redraw();
    if (hint) this.say(sentence(hint));
  }

  /** Moves the chosen handle by an arrow key; false if there is none chosen. */
  nudge(key, tenfold) {
    const handle = this.list[this.chosen];
    if (!handle || !ARROWS[key]) return false;
    const [sideways, upwards] = ARROWS[key];
    const refused = refusal(handle, sideways !== 0);
    this.byKeys(refused);
    if (refused) return true;
    const times = tenfold ? 10 : 1;
    const { t, y } = this.placeOf(this.chosen);
    this.pulled = { index: this.chosen, t, y, off: [0, 0], done: 0 };
    const step = KEY_STEPS[handle.panel] ?? KEY_STEPS.temperature;
    this.moveTo(t + sideways * times * KEY_STEPS.t, y + upwards * times * step);
    return true;
  }

  described(index) {
    const handle = this.list[index];
    const where = `Corner ${index + 1} of ${this.list.length}, line ${handle.line}: ${this.coordinates(index)}.`;
    if (!movable(handle)) return `${where} It does not move: ${handle.why ?? ""}`;
    const ways = handle.moves_time ? (handle.moves_level ? "Arrows move it." : "Left and right move it.") : "Up and down move it.";
    return `${where} ${ways}`;
  }

  coordinates(index) {
    const { t, y } = this.placeOf(index);
    const unit = this.list[index].panel === "current" ? "A" : "°C";
    return `${numberText(t, 2)} s, ${numberText(y, 2)} ${unit}`;
  }

  /** The text beside the handle that is hovered, chosen or pulled: {index, text} or null. */
  tip() {
    const index = this.pulled ? this.pulled.index : this.hovered >= 0 ? this.hovered : this.chosen;
    const handle = this.list[index];
    if (!handle) return null;
    const text = `line ${handle.line} · ${this.coordinates(index)}`;
    if (!movable(handle)) return { index, text: `${text} · fixed: ${handle.why ?? "it does not move"}` };
    return { index, text: this.hint && index === this.chosen ? `${text} · ${this.hint}` : text };
  }

  draw(context, panel, lay, palette) {
    this.list.forEach((handle, index) => {
      if (handle.panel === panel) this.drawOne(context, handle, index, lay, palette);
    });
  }

  drawOne(context, handle, index, lay, palette) {
    const { t, y } = this.placeOf(index);
    const [across, down] = [lay.x(t), lay.y(y)];
    const lively = index === this.hovered || this.pulled?.index === index;
    context.setLineDash([]);
    if (index === this.chosen) ring(context, across, down, 10, palette.focus, 2);
    context.beginPath();
    context.arc(across, down, movable(handle) ? (lively ? 7 : 5.5) : 4, 0, 2 * Math.PI);
    context.fillStyle = movable(handle) ? palette.focus : palette.paper;
    context.fill();
    context.lineWidth = movable(handle) ? 2 : 1.5;
    context.strokeStyle = movable(handle) ? palette.paper : palette.grey;
    context.stroke();
  }
}

function movable(handle) {
  return handle.moves_time || handle.moves_level;
}

/** Why a handle does not go along time (or along the level), or "" if it does. */
function refusal(handle, inTime) {
  if (inTime ? handle.moves_time : handle.moves_level) return "";
  if (handle.why) return handle.why;
  return movable(handle) ? `this corner moves in ${handle.moves_time ? "time" : "level"} only` : "this corner does not move";
}

function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");
}

function ring(context, across, down, radius, colour, width) {
  context.beginPath();
  context.arc(across, down, radius, 0, 2 * Math.PI);
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.stroke();
}

/** The pointer's shape over a handle says which ways it goes. */
function pointerOver(handle) {
  if (!handle) return "crosshair";
  if (!movable(handle)) return "not-allowed";
  if (handle.moves_time && handle.moves_level) return "move";
  return handle.moves_time ? "ew-resize" : "ns-resize";
}
