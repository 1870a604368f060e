// Over the curves: the icons of a set one after another with their names, or without them as a quiz.

const PAUSE_MS = 1000; // between two icons of a set
const NOTHING = "nothing felt";
const REHEARSAL = "A rehearsal with the model's predictions: these counts are not data, since you see a patch and feel nothing.";

class Reel {
  constructor(player, say) {
    Object.assign(this, { player, say, open: false, timer: 0, line: null });
    this.title = make("h3", { class: "tm-reel-title", tabindex: -1 });
    this.closer = make("button", { type: "button", class: "tm-button", title: "back to the curves (Esc)", onclick: () => player.stop() }, "Close");
    this.older = make("span", { class: "tm-reel-older", hidden: true }, "older than the text");
    this.body = make("div", { class: "tm-reel-body" });
    this.element = make(
      "div",
      { class: "tm-reel", role: "group", "aria-label": "Preview of the set", hidden: true, "data-lm-suppress-shortcuts": "true" },
      make("div", { class: "tm-reel-head" }, this.title, this.older, this.closer), this.body,
    );
  }

  /** `remark` says what of the set is left out. */
  begin(kind, frames, remark) {
    Object.assign(this, { open: true, kind, frames, remark: remark ?? "", at: -1 });
    this.element.hidden = false;
    if (kind === "set") {
      this.line = new Timeline(this.player.timeline.root, null, this.say);
      this.body.replaceChildren(this.line.element);
      this.line.keys = this.player.timeline.keys;
      this.next();
      this.line.stage.focus({ preventScroll: true });
    } else this.beginQuiz();
    this.age();
  }

  /** Whether the set that plays is of another text than the one that stands in the editor. */
  age() {
    if (this.open) this.older.hidden = this.frames[0].of === this.player.text() && !this.player.frame.stale;
  }

  /** The next icon of the set, or the end. */
  next() {
    this.at += 1;
    if (this.at >= this.frames.length) return this.player.stop();
    const frame = this.frames[this.at];
    frame.panels = frame.panels.filter(({ key }) => key === "temperature" || key === "sensation");
    this.line.cursor = frame.time.t0;
    this.line.show(frame);
    setText(this.title, `${this.at + 1} of ${this.frames.length}: ${frame.icon}${this.remark && ` (${this.remark})`}`);
    this.say(`${frame.icon}`);
    const show = (t) => {
      this.line.moveCursor(t);
      this.player.patch.show(frame, t);
    };
    this.line.playing = true;
    this.player.run.start(() => frame, show, () => (this.timer = setTimeout(() => this.next(), PAUSE_MS)), frame.icon);
  }

  beginQuiz() {
    this.counts = this.frames.map(() => ({ played: 0, right: 0, others: new Map() }));
    this.left = [];
    this.prompt = make("p", { class: "tm-quiz-prompt", role: "status" });
    const answer = (name) => make("button", { type: "button", class: "tm-button", onclick: () => this.answer(name) }, name);
    this.answers = make("div", { class: "tm-answers", role: "group", "aria-label": "Which icon was it?" }, ...this.frames.map(({ icon }) => answer(icon)), answer(NOTHING));
    this.again = make("button", { type: "button", class: "tm-button", onclick: () => this.playQuiz() }, "Again");
    this.go = make("button", { type: "button", class: "tm-button tm-next", onclick: () => this.ask() }, "Next");
    this.table = make("tbody", {});
    const heads = ["icon", "played", "right", "taken for"].map((head) => make("th", { scope: "col" }, head));
    const table = make("table", { class: "tm-counts" }, make("caption", {}, REHEARSAL), make("thead", {}, make("tr", {}, ...heads)), this.table);
    const keys = make("div", { class: "tm-quiz-keys" }, this.prompt, this.again, this.go);
    this.body.replaceChildren(make("div", { class: "tm-quiz" }, this.player.patch.element, make("div", {}, keys, this.answers, table)));
    this.ask();
  }

  /** Each icon comes once, in an order that nobody knows, before any comes again. */
  ask() {
    if (!this.left.length) {
      this.left = this.frames.map((_, k) => k);
      for (let k = this.left.length - 1; k > 0; k -= 1) {
        const other = Math.floor(Math.random() * (k + 1));
        [this.left[k], this.left[other]] = [this.left[other], this.left[k]];
      }
    }
    this.at = this.left.pop();
    this.asking = true;
    setText(this.title, "Which icon is it?");
    this.playQuiz();
    this.show();
    this.title.focus({ preventScroll: true }); // Next is disabled now, and would take the keys with it
  }

  playQuiz() {
    const frame = this.frames[this.at];
    setText(this.prompt, "Watch the patch, then choose the name.");
    this.player.run.start(() => frame, (t) => this.player.patch.show(frame, t), () => {}, this.asking ? "the icon" : frame.icon);
  }

  answer(name) {
    if (!this.asking) return;
    const [count, right] = [this.counts[this.at], this.frames[this.at].icon];
    this.player.run.stop();
    this.asking = false;
    count.played += 1;
    if (name === right) count.right += 1;
    else count.others.set(name, (count.others.get(name) ?? 0) + 1);
    setText(this.prompt, name === right ? `Right: ${right}.` : `It was ${right}, not ${name}.`);
    this.show();
    this.go.focus({ preventScroll: true });
  }

  show() {
    this.go.disabled = this.asking;
    for (const each of this.answers.children) each.disabled = !this.asking;
    this.table.replaceChildren(...this.frames.map(({ icon }, k) => {
      const { played, right, others } = this.counts[k];
      const taken = [...others].map(([name, times]) => (times > 1 ? `${name} (${times})` : name)).join(", ");
      return make("tr", {}, make("th", { scope: "row" }, icon), ...[played, right, taken].map((value) => make("td", {}, String(value))));
    }));
  }

  close() {
    if (!this.open) return;
    clearTimeout(this.timer);
    this.line?.stop();
    Object.assign(this, { open: false, line: null });
    const inside = this.element.contains(document.activeElement);
    this.element.hidden = true;
    this.player.place.replaceChildren(this.player.patch.element);
    this.body.replaceChildren();
    this.player.follow();
    if (inside) this.player.timeline.stage.focus({ preventScroll: true });
  }
}
