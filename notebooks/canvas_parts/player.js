// What plays, below the text: the icon that is shown, its set, and a quiz.

class Player {
  /** `post` sends a message to the kernel; `text()` is what stands in the editor. */
  constructor(timeline, post, text, say) {
    Object.assign(this, { timeline, post, text, say, wanted: null, device: false, stopDevice: () => {} });
    this.run = new Run(say);
    this.patch = new Patch();
    this.reel = new Reel(this, say);
    this.build();
    timeline.onCursor = () => this.follow();
    timeline.keys[" "] = () => this.toggle();
    timeline.keys.Escape = () => this.stop();
    timeline.element.append(this.reel.element);
  }

  build() {
    const button = (text, title, act) => make("button", { type: "button", class: "tm-button", title, onclick: act }, text);
    this.play = button("▶ Play", "in real time, as predicted (Space on the time line; Esc stops)", () => this.toggle());
    const speeds = SPEEDS.map(([speed, name]) => make("option", { value: speed, selected: speed === 1 }, name));
    this.speed = make("select", { class: "tm-select tm-speed", "aria-label": "Speed", onchange: () => (this.run.speed = Number(this.speed.value)) }, ...speeds);
    this.sound = make("button", {
      type: "button", class: "tm-button", "aria-pressed": "false", title: "a tone: its pitch is the skin's temperature, its loudness what is felt",
      onclick: () => this.turnTone(),
    }, "♪ Tone");
    this.whole = button("Play set", "all icons one after another", () => this.want("set"));
    this.quiz = button("Quiz", "one icon after another without its name: which is it?", () => this.want("quiz"));
    this.bar = make("div", { class: "tm-player-bar", role: "toolbar", "aria-label": "Preview and versions" }, this.play, this.speed, this.sound, this.whole, this.quiz);
    this.place = make("div", { class: "tm-patch-place" }, this.patch.element);
    this.element = make("div", { class: "tm-player" }, this.bar, this.place);
    this.element.player = this; // for tests
  }

  turnTone() {
    this.run.tone.turn(!this.run.tone.on);
    this.sound.setAttribute("aria-pressed", String(this.run.tone.on));
  }

  get frame() {
    return this.timeline.frame;
  }

  /** A frame came; another icon than the one that plays ends the play. */
  show(frame) {
    const empty = frame.panels.length === 0;
    this.play.disabled = empty && !this.device;
    for (const each of [this.whole, this.quiz]) each.disabled = empty || this.device;
    if (this.timeline.playing && frame.icon !== this.run.name) this.stop();
    this.reel.age();
  }

  /** While a device plays, nothing is previewed, and Play, Space and Escape stop the device. */
  deviceRuns(plays) {
    if (plays === this.device) return;
    this.device = false;
    this.stop();
    this.device = plays;
    this.ended();
    for (const each of [this.speed, this.sound, this.whole, this.quiz]) each.disabled = plays;
    setText(this.patch.about, plays ? "a device plays: no preview" : PREDICTED);
    this.say(plays ? "A device plays. Space on the time line stops it." : "The device is off.");
  }

  /** Begins or ends a play of the icon that is shown. */
  toggle() {
    if (this.stop() || !this.frame?.panels.length) return true;
    this.timeline.playing = true;
    this.run.start(() => this.frame, (t) => this.timeline.moveCursor(t), () => this.ended(), this.frame.icon);
    setText(this.play, "■ Stop");
    return true;
  }

  /** Ends what plays and what covers the curves; false if nothing did. */
  stop() {
    if (this.device) this.stopDevice();
    const any = this.device || this.run.playing || this.wanted !== null || this.reel.open;
    this.run.stop();
    this.reel.close();
    this.ended();
    return any;
  }

  ended() {
    this.timeline.playing = false;
    this.wanted = null;
    setText(this.play, this.device ? "■ Stop the device" : "▶ Play");
  }

  /** Asks the kernel for the curves of all icons; from then on it is not needed. */
  want(kind) {
    this.stop();
    this.wanted = kind;
    setText(this.play, "■ Stop");
    setText(this.patch.word, "asking for the set …");
    this.post({ type: "reel" });
  }

  take(meta, buffers) {
    if (this.wanted === null) return; // another page asked, or it was stopped
    const kind = this.wanted;
    const frames = meta.frames.map((each) => tracesFrame(each, buffers.splice(0, each.buffers)));
    if (!frames.length) {
      this.stop();
      setText(this.patch.word, meta.why);
      return this.say(meta.why);
    }
    this.wanted = null;
    this.reel.begin(kind, frames, meta.why);
  }

  /** The patch shows what is felt at the cursor, whether time runs or not. */
  follow() {
    if (this.frame?.panels.length && !this.reel.open && this.wanted === null) this.patch.show(this.frame, this.timeline.cursor);
  }
}
