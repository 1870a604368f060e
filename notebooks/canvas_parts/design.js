// The design view: text on the left, time line on the right, and what is true of both above and below.

const BADGES = {
  green: { word: "limits kept", sign: "\u2713" },
  amber: { word: "caution", sign: "!" },
  red: { word: "not safe", sign: "\u2715" },
  grey: { word: "not judged", sign: "?" },
};

const TEXT_LAGS_MS = 100; // behind a pulled corner

class DesignView {
  /** `id` tells one model of the kernel from another. */
  constructor(root, flow, say, id) {
    Object.assign(this, { root, flow, say, editSeq: 0, asked: 0, drawn: 0, notes: "", onLocalText: () => {}, onNewer: () => {} });
    this.unsaved = new UnsavedText(id, (text) => this.tellLeft(text));
    this.editor = new Editor(root, {
      onText: (text) => this.edited(text),
      onCaret: (word) => this.followCaret(word),
      onCommand: (type) => flow.post({ type }),
      onApply: (line) => flow.post({ type: "apply", line }),
    });
    this.timeline = new Timeline(root, (message) => flow.post(message), say);
    this.timeline.onHandle = (line, follow) => this.editor.pointAt(line, follow);
    this.badge = new Badge(say);
    this.player = new Player(this.timeline, (message) => flow.post(message), () => this.editor.text, say);
    this.player.stopDevice = () => flow.tell({ type: "stop device" });
    this.sides = new Sides((message) => flow.post(message), (message) => this.ask(message));
    this.timeline.keys.b = () => this.sides.change();
    this.palette = new Palette(this.editor, (message) => flow.post(message), say);
    this.strip = new Strip((text) => this.ask({ type: "goal", text }), say);
    this.element = this.build();
  }

  build() {
    const { flow } = this;
    const button = (type, sign, name, keys) =>
      make("button", { type: "button", class: "tm-button", title: `${name} (${keys})`, onclick: () => flow.post({ type }) },
        make("span", { "aria-hidden": true, class: "tm-sign" }, sign), name);
    this.picker = make("select", { class: "tm-picker", title: "icon", onchange: () => this.ask({ type: "icon", name: this.picker.value }) });
    this.undo = button("undo", "\u21b6", "Undo", "Ctrl+Z");
    this.redo = button("redo", "\u21b7", "Redo", "Ctrl+Shift+Z");
    this.noteList = make("ul", { class: "tm-notes", "aria-label": "Notes", hidden: true });
    const picker = make("label", { class: "tm-pick" }, "Icon ", this.picker);
    const bar = make("div", { class: "tm-bar", role: "toolbar", "aria-label": "Icon and safety" }, picker, this.strip.element, this.badge.element);
    this.editor.element.prepend(make("div", { class: "tm-editor-bar", role: "toolbar", "aria-label": "Text" }, this.undo, this.redo, this.palette.element));
    this.player.bar.append(this.sides.pin);
    const split = make("div", { class: "tm-split" }, make("div", { class: "tm-left" }, this.editor.element, this.player.element), this.timeline.element);
    const escape = (event) => event.key === "Escape" && this.player.stop() && event.stopPropagation();
    return make("div", { class: "tm-design", onkeydown: escape }, bar, this.sides.element, split, this.noteList);
  }

  edited(text) {
    this.editSeq = this.ask({ type: "text", text });
    this.unsaved.note(text);
    this.onLocalText(text);
  }

  /** Shows the icon that the caret entered; of a family the member that is shown, or its first. */
  followCaret(word) {
    const within = (name) => name === word || name.startsWith(`${word}_`);
    const name = within(this.picker.value) ? null : this.frame?.icons.find(within);
    if (!name) return;
    this.picker.value = name;
    this.ask({ type: "icon", name });
  }

  /** Posts what the page shows already, while badge, strip and curves are those of what stood there before. */
  ask(message) {
    this.question = message;
    this.asked = this.flow.post(message);
    this.onNewer();
    return this.asked;
  }

  /** Shows whether all this is of another text than the one that stands here, or of another rig or icon, and why. */
  age(late, computing) {
    if (!this.frame) return;
    const { icon, badge, stale, of } = this.frame;
    const other = !this.later && asHeld(of) !== this.editor.text;
    const why = late ? "no answer" : stale ? "" : computing ? "computing …" : other ? "of another text" : "";
    const shown = why ? { colour: "grey", text: `not judged: ${why}`, more: [] } : badge;
    const older = Boolean(why || stale);
    for (const place of [this.root, this.root.closest(".thermicon")]) place?.toggleAttribute("data-older", older);
    this.badge.show(shown, Boolean(why) && !late);
    this.strip.age(older);
    this.player.reel.age();
    Object.assign(this.root.dataset, { icon: icon ?? "", colour: shown.colour });
  }

  /** The kernel offers what an earlier bench left, above the editor. */
  tellLeft(text) {
    this.flow.tell({ type: "left", text });
    const said = "An earlier text was saved. Buttons above the editor restore or discard it.";
    setTimeout(() => this.say(said), 0); // after what the first frame says
  }

  get textPending() {
    return this.editSeq > this.flow.answered;
  }

  /** Takes a text of the kernel or of another view of the same model, unless something newer was typed here. */
  takeText(text) {
    if (text === null || this.textPending) return;
    this.editor.replace(text);
    this.unsaved.note(text);
  }

  show(frame) {
    this.showTextOf(frame);
    this.showIcons(frame);
    this.undo.disabled = !frame.can_undo;
    this.redo.disabled = !frame.can_redo;
    this.showNotes(frame.notes);
    this.timeline.show(frame);
    this.player.show(frame);
    this.frame = frame;
  }

  /** While a corner is pulled, the text follows after the curves, once the page has time. */
  showTextOf(frame) {
    const take = () => {
      clearTimeout(this.later);
      this.later = 0;
      this.takeText(frame.text);
      if (!this.textPending) this.editor.show(frame.troubles);
    };
    this.newestText = take;
    if (!this.timeline.handles.pulledBeyond(frame.seq)) take();
    else this.later ||= setTimeout(() => {
      this.newestText();
      this.onNewer();
    }, TEXT_LAGS_MS);
  }

  showIcons({ icons, icon }) {
    const names = icons.join("\n");
    if (names !== this.names) {
      this.names = names;
      this.picker.replaceChildren(...icons.map((name) => make("option", { value: name }, name)));
      this.picker.disabled = icons.length === 0;
    }
    if (icon !== null && this.picker.value !== icon) this.picker.value = icon;
    if (icon !== this.icon && !this.editor.element.contains(document.activeElement)) this.editor.revealIcon(icon);
    this.icon = icon;
  }

  showNotes(notes) {
    const text = notes.join("\n");
    if (text === this.notes) return;
    this.notes = text;
    this.noteList.replaceChildren(...notes.map((note) => make("li", {}, note)));
    this.noteList.hidden = notes.length === 0;
    if (notes.length) this.say(notes[0]);
  }

  stop() {
    clearTimeout(this.later);
    this.player.stop();
    this.palette.stop();
    this.editor.stop();
    this.timeline.stop();
    this.badge.stop();
  }
}

/** The verdict on safety as colour, sign and word, with the rule and its time; a click shows the whole. */
class Badge {
  constructor(say) {
    Object.assign(this, { colour: null, say });
    this.more = make("ul", { class: "tm-badge-more", id: uniqueId("badge"), hidden: true });
    this.pill = make("span", { class: "tm-pill" });
    this.text = make("span", { class: "tm-badge-text" });
    this.button = make(
      "button",
      { class: "tm-badge-button", type: "button", "aria-expanded": "false", "aria-controls": this.more.id, onclick: () => this.open(this.more.hidden) },
      this.pill, this.text,
    );
    this.element = make("div", { class: "tm-badge", onkeydown: (event) => event.key === "Escape" && this.open(false) }, this.button, this.more);
    this.outside = (event) => !this.element.contains(event.target) && this.open(false);
    document.addEventListener("pointerdown", this.outside, true);
  }

  open(open) {
    this.more.hidden = !open || !this.more.children.length;
    this.button.setAttribute("aria-expanded", String(!this.more.hidden));
  }

  /** `passing`: it stands for moments only, so that screen readers are not told. */
  show({ colour, text, more }, passing) {
    const { word, sign } = BADGES[colour] ?? BADGES.grey;
    this.element.dataset.colour = colour;
    if (this.button.title !== text) this.button.title = text;
    setText(this.pill, `${sign} ${word}`);
    setText(this.text, text.slice(text.indexOf(`${word}: `) < 0 ? 0 : text.indexOf(`${word}: `) + word.length + 2)); // the pill says the word
    if (this.button.title !== text) this.button.title = text;
    const lines = (more ?? []).join("\n");
    if (lines !== this.lines) {
      this.lines = lines;
      this.more.replaceChildren(...(more ?? []).map((line) => make("li", {}, line)));
      this.open(!this.more.hidden);
    }
    if (passing) return;
    if (this.colour !== null && this.colour !== colour) this.say(`Safety: ${word}. ${text}`);
    this.colour = colour;
  }

  stop() {
    document.removeEventListener("pointerdown", this.outside, true);
  }
}

/** Two icons over each other: the time line alone. */
class TracesView {
  constructor(root, flow, say) {
    this.timeline = new Timeline(root, null, say);
    this.noteList = make("ul", { class: "tm-notes", "aria-label": "Notes", hidden: true });
    this.element = make("div", { class: "tm-traces" }, this.timeline.element, this.noteList);
  }

  show(frame) {
    this.timeline.show(frame);
    this.noteList.replaceChildren(...frame.notes.map((note) => make("li", {}, note)));
    this.noteList.hidden = frame.notes.length === 0;
  }

  stop() {
    this.timeline.stop();
  }
}
