// What anywidget calls: a view of the kernel's newest frame in an element of the page.

const VIEWS = {
  design: { make: DesignView, read: tracesFrame },
  traces: { make: TracesView, read: tracesFrame },
  heat: { make: HeatView, read: heatFrame },
};
const LATE = "No answer from the kernel: run the cell again to go on";
const WATCH_MS = 1000;
const TOUCHES = ["pointerdown", "pointerup", "keydown", "change"];
const siblings = new Map(); // the workbenches of one model on this page, which show one text

class Workbench {
  constructor(model, el) {
    Object.assign(this, { model, view: null, kind: null, newest: null, raf: 0 });
    this.lateText = make("span", { role: "alert" });
    this.copy = make("button", { type: "button", class: "tm-button", onclick: () => this.copyText() }, "Copy text");
    this.banner = make("div", { class: "tm-banner", hidden: true }, this.lateText, this.copy);
    this.live = make("div", { class: "tm-unseen tm-live-region", "aria-live": "polite" });
    this.place = make("div", { class: "tm-place" }, make("p", { class: "tm-waiting" }, "Waiting for the first drawing …"));
    this.root = make("div", { class: "tm-root" }, this.banner, this.place, this.live);
    this.say = whenQuiet((text) => setText(this.live, text), 600);
    this.flow = new Flow((message) => model.send(message), (late) => this.showLate(late));
    this.key = model.get?.("key") || model.model_id || model;
    this.onMessage = (meta, buffers) => this.receive(meta, buffers);
    this.root.workbench = this; // for tests, and for whoever looks into the page
    el.append(this.root);
    followSystem();
    this.onTouch = (event) => this.touched(event);
    for (const name of TOUCHES) document.addEventListener(name, this.onTouch, true);
    model.on("msg:custom", this.onMessage);
    if (!siblings.has(this.key)) siblings.set(this.key, new Set());
    siblings.get(this.key).add(this);
    const view = model.get?.("view");
    if (VIEWS[view]) this.become(view);
    this.flow.hello();
    this.watch = setInterval(() => this.lost && this.flow.giveUp(), WATCH_MS);
  }

  /** Whether ipywidgets has marked this view as one whose kernel is gone. */
  get lost() {
    return this.root.closest(".jupyter-widgets-disconnected") !== null;
  }

  /** Knobs and rig go to the kernel by ipywidgets; asked for an answer after that, it is seen to be late for them too. */
  touched({ type, target }) {
    const ours = this.root.closest(".thermicon")?.contains(target) && !this.root.contains(target);
    const turned = this.held && type === "pointerup"; // a knob may be let go beside it
    if (!turned && !(ours && (type === "change" || target.closest(".thermicon-knobs")))) return;
    this.held = type === "pointerdown";
    this.turned = true;
    setTimeout(() => this.view?.ask?.({ type: "hello" }), 0);
  }

  showLate(late) {
    this.again ||= late && this.turned;
    const { unsaved } = this.view ?? {};
    const text = unsaved?.place ? (unsaved.works ? "; your text is saved in this page" : "; copy your text first") : "";
    this.banner.hidden = !late;
    this.copy.hidden = !text;
    setText(this.copy, "Copy text");
    setText(this.lateText, late ? LATE + text : "");
    this.age();
  }

  /** Silence, and what a view was asked and has not drawn, are true of all views of the model. */
  age() {
    const all = [...(siblings.get(this.key) ?? [])].filter(({ view }) => view?.age);
    const late = all.some(({ flow }) => flow.late);
    const computing = all.some(({ view }) => view.asked > view.drawn);
    for (const { view } of all) view.age(late, computing);
  }

  async copyText() {
    const copied = await copyText(this.view.editor);
    setText(this.copy, copied ? "Copied" : "Copy text");
    this.say(copied ? "Text copied" : "The text is selected: copy it with Ctrl+C");
  }

  receive(meta, buffers) {
    if (meta?.type === "alive") this.flow.arrived(0); // nothing is drawn yet
    if (meta?.type === "strip") {
      this.view?.strip?.show(meta);
      this.view?.sides?.show(meta.sides ?? []);
    }
    if (meta?.type === "reel") this.view?.player?.take(meta, buffers);
    if (meta?.type === "device") this.view?.player?.deviceRuns(meta.plays);
    if (meta?.type === "palette") this.view?.palette?.show(meta.sets);
    if (meta?.type !== "frame") return;
    const sent = this.flow.arrived(meta.seq ?? 0);
    const older = this.newest; // a frame that is never drawn may still be the one that brings a text
    const text = meta.text ?? older?.meta.text ?? null;
    this.newest = { meta: { ...meta, text }, buffers, sent: sent ?? older?.sent ?? null, arrived: performance.now() };
    if (!this.raf) this.raf = requestAnimationFrame(() => this.draw());
  }

  draw() {
    const { meta, buffers, sent, arrived } = this.newest;
    this.raf = 0;
    this.newest = null;
    const began = performance.now();
    const kind = VIEWS[meta.view] ? meta.view : this.kind ?? "traces";
    if (kind !== this.kind) this.become(kind);
    if (!this.view.element.isConnected) this.place.replaceChildren(this.view.element);
    const frame = VIEWS[kind].read(meta, buffers);
    this.view.drawn = this.flow.answered;
    this.view.show(frame);
    this.repeat();
    this.age();
    if (frame.troubles && !this.view.textPending) this.sayTroubles(frame.troubles);
    this.root.dataset.seq = frame.seq;
    if (kind === "design") tendControls(this.root);
    const drawn = performance.now();
    measure(kind, { seq: frame.seq, sent_ms: sent, arrived_ms: arrived, drawn_ms: drawn, kernel_ms: frame.ms, draw_ms: drawn - began });
  }

  become(kind) {
    this.view?.stop();
    this.kind = kind;
    this.root.dataset.view = kind;
    this.view = new VIEWS[kind].make(this.root, this.flow, this.say, typeof this.key === "string" ? this.key : uniqueId("model"));
    this.view.onNewer = () => this.age();
    this.view.onLocalText = (text) => this.tellSiblings((view) => view.takeText?.(text));
  }

  /** Views of one model show one text: what is typed in one stands in the others at once. */
  tellSiblings(tell) {
    for (const other of siblings.get(this.key)) if (other !== this && other.view) tell(other.view);
  }

  /** What got no answer is sent again as soon as the kernel shows life; last, what ipywidgets held back is asked for. */
  repeat() {
    const { flow, view } = this;
    if (!view.ask || flow.inFlight !== null || flow.waiting.size > 0) return;
    if (view.textPending) view.edited(view.editor.text);
    else if (view.asked > flow.answered) view.ask(view.question);
    else if (this.again) {
      this.again = this.turned = false;
      view.ask({ type: "hello" });
    }
  }

  sayTroubles(troubles) {
    const text = troubles.map(({ line, code, headline }) => `Line ${line}: ${code} ${headline}`).join(". ");
    if (text !== (this.troublesSaid ?? "")) this.say(text || "No errors");
    this.troublesSaid = text;
  }

  stop() {
    cancelAnimationFrame(this.raf);
    clearInterval(this.watch);
    for (const name of TOUCHES) document.removeEventListener(name, this.onTouch, true);
    this.model.off?.("msg:custom", this.onMessage);
    this.flow.stop();
    this.say.cancel();
    this.view?.stop();
    siblings.get(this.key)?.delete(this);
    if (!siblings.get(this.key)?.size) siblings.delete(this.key);
    this.root.remove();
  }
}

async function render({ model, el }) {
  const text = model.get?.("view") === "design";
  try {
    if (text) await loadCodeMirror();
  } catch (problem) {
    el.append(make("p", { role: "alert" }, `The editor cannot be loaded; a newer browser may help (${problem.message})`));
    throw problem;
  }
  const workbench = new Workbench(model, el);
  return () => workbench.stop();
}

export default { render };
