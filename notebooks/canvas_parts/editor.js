// The cue text: a plain textarea, so that caret, selection, input methods and screen readers work as everywhere, over a
// coloured copy of the same text. Lines are far enough apart for an error in small print under its line.

const LINE_PX = 26;
const TOP_PX = 4;

class Editor {
  /** `onText`, `onUndo`, `onRedo` and `onApply(line)` are told what the person does. */
  constructor({ onText, onUndo, onRedo, onApply }) {
    Object.assign(this, { onText, onUndo, onRedo, lines: [], numbers: 0, livePlace: 0 });
    this.troubles = new Troubles(this, onApply);
    this.build();
    this.observer = new ResizeObserver(() => this.troubles.place());
    this.observer.observe(this.scroller);
  }

  build() {
    this.status = make("div", { class: "tm-status", id: uniqueId("status") });
    this.area = make("textarea", {
      class: "tm-area", "aria-label": "Cue text", "aria-describedby": this.status.id, spellcheck: "false",
      autocomplete: "off", autocapitalize: "off", autocorrect: "off", wrap: "off", "data-lm-suppress-shortcuts": "true",
      oninput: () => this.edited(),
      onkeydown: (event) => this.onKey(event),
      onkeyup: () => this.stayLeft(),
    });
    // A click on a line number keeps the focus in the text: elsewhere, JupyterLab takes letters as commands on cells.
    this.gutter = make("div", {
      class: "tm-numbers", "aria-hidden": true,
      onmousedown: (event) => { event.preventDefault(); this.area.focus({ preventScroll: true }); },
    });
    this.backdrop = make("div", { class: "tm-backdrop", "aria-hidden": true });
    const page = make("div", { class: "tm-page" }, this.backdrop, this.area, this.troubles.element);
    this.scroller = make("div", { class: "tm-scroller" }, this.gutter, page);
    this.element = make("div", { class: "tm-editor" }, this.scroller, this.status);
    this.troubles.sayStatus();
    this.paint();
  }

  get text() {
    return this.area.value;
  }

  edited() {
    this.paint();
    this.stayLeft();
    this.onText(this.area.value);
  }

  /** The text stands at its left end whenever the caret can be seen there: browsers scroll further than needed. */
  stayLeft() {
    if (!this.scroller.scrollLeft) return;
    const { value, selectionEnd } = this.area;
    const column = selectionEnd - value.lastIndexOf("\n", selectionEnd - 1);
    if (column * 8.5 < this.scroller.clientWidth - this.gutter.offsetWidth - 16) this.scroller.scrollLeft = 0;
  }

  /** Puts in a text from the kernel; caret and scrolling stay with the words around them. */
  replace(text) {
    const old = this.area.value;
    if (text === old) return;
    const head = commonHead(old, text);
    const tail = commonTail(old, text, head);
    const { scrollTop, scrollLeft } = this.scroller;
    this.area.setRangeText(text.slice(head, text.length - tail), head, old.length - tail, "preserve");
    this.paint();
    if (document.activeElement === this.area) Object.assign(this.scroller, { scrollTop, scrollLeft });
  }

  show(troubles) {
    this.troubles.take(troubles);
    this.paint();
  }

  /** Renews the coloured copy, but only of lines that changed. */
  paint() {
    const lines = this.area.value.split("\n");
    const wrong = this.troubles.byLine();
    const looks = lines.map((line, k) => line + (wrong.has(k + 1) ? `\n${JSON.stringify(wrong.get(k + 1))}` : ""));
    const head = commonHead(this.lines, looks);
    const tail = commonTail(this.lines, looks, head);
    const fresh = lines.slice(head, lines.length - tail).map((line, k) => lineElement(line, wrong.get(head + k + 1) ?? []));
    const old = [...this.backdrop.children].slice(head, this.lines.length - tail);
    const after = this.backdrop.children[this.lines.length - tail] ?? null;
    old.forEach((element) => element.remove());
    for (const element of fresh) this.backdrop.insertBefore(element, after);
    this.lines = looks;
    this.backdrop.querySelectorAll(".tm-live").forEach((element) => element.classList.remove("tm-live"));
    this.backdrop.children[this.livePlace - 1]?.classList.add("tm-live");
    this.paintNumbers(lines.length, wrong);
    this.troubles.place();
  }

  paintNumbers(count, wrong) {
    while (this.gutter.children.length > count) this.gutter.lastChild.remove();
    while (this.gutter.children.length < count) this.gutter.append(make("div", {}, String(this.gutter.children.length + 1)));
    for (const [k, element] of [...this.gutter.children].entries()) {
      element.className = wrong.has(k + 1) ? "tm-wrong-number" : k + 1 === this.livePlace ? "tm-live-number" : "";
    }
  }

  /** Shows which line a corner belongs to (0: none), and scrolls there if `follow`. */
  pointAt(line, follow) {
    if (line !== this.livePlace) {
      for (const list of [this.backdrop, this.gutter]) list.children[this.livePlace - 1]?.classList.remove("tm-live", "tm-live-number");
      this.livePlace = line;
      this.backdrop.children[line - 1]?.classList.add("tm-live");
      this.gutter.children[line - 1]?.classList.add("tm-live-number");
    }
    if (follow && line) this.reveal(line);
  }

  reveal(line) {
    const top = (line - 1) * LINE_PX;
    const { scrollTop, clientHeight } = this.scroller;
    if (top < scrollTop || top + 2 * LINE_PX > scrollTop + clientHeight) this.scroller.scrollTop = top - clientHeight / 3;
  }

  /** Scrolls to where an icon, or the family that it belongs to, begins. */
  revealIcon(name) {
    const words = this.text.split("\n").map((line) => /^\s*icon\s+([^\s({]+)/.exec(line)?.[1]);
    const own = words.indexOf(name);
    const line = own < 0 ? words.findIndex((word) => word && name?.startsWith(`${word}_`)) : own;
    if (line >= 0) this.scroller.scrollTop = Math.max(0, line - 2) * LINE_PX;
  }

  /** Puts the caret at a place of the text, counted from 1. */
  goTo(line, column) {
    const before = this.area.value.split("\n").slice(0, line - 1).join("\n");
    const own = this.area.value.split("\n")[line - 1] ?? "";
    const at = before.length + (line > 1 ? 1 : 0) + offsetOf(own, column);
    this.area.focus({ preventScroll: true });
    this.area.setSelectionRange(at, at);
    this.reveal(line);
  }

  onKey(event) {
    if (event.isComposing) return;
    const command = (event.ctrlKey || event.metaKey) && !event.altKey;
    const key = event.key.toLowerCase();
    if (command && (key === "z" || key === "y")) {
      event.preventDefault();
      if (key === "y" || event.shiftKey) this.onRedo();
      else this.onUndo();
    } else if (command && key === "s") passOn(event, this.element);
    else if (event.key === "Enter" && !command && !event.shiftKey) this.breakLine(event);
  }

  /** A new line begins where the line before began, two further inside of a block. */
  breakLine(event) {
    event.preventDefault();
    const { value, selectionStart, selectionEnd } = this.area;
    const line = value.slice(value.lastIndexOf("\n", selectionStart - 1) + 1, selectionStart);
    const indent = /^[ \t]*/.exec(line)[0] + (/\{\s*(#.*)?$/.test(line) ? "  " : "");
    this.area.setRangeText(`\n${indent}`, selectionStart, selectionEnd, "end");
    this.edited();
    this.reveal(this.area.value.slice(0, this.area.selectionStart).split("\n").length);
  }

  stop() {
    this.observer.disconnect();
    this.troubles.stop();
  }
}

function lineElement(line, troubles) {
  return make("div", { class: "tm-line" }, ...lineElements(line, troubles));
}

/** Saving belongs to the page around: the shortcut, which the editor keeps from it otherwise, is given to it. */
function passOn(event, element) {
  const outside = element.closest(".tm-root")?.parentElement;
  if (!outside?.closest(".jp-Notebook")) return;
  event.preventDefault();
  const { key, code, keyCode, ctrlKey, metaKey, shiftKey } = event;
  outside.dispatchEvent(new KeyboardEvent("keydown", { key, code, keyCode, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true }));
}

function commonHead(one, other) {
  let count = 0;
  while (count < one.length && count < other.length && one[count] === other[count]) count += 1;
  return count;
}

function commonTail(one, other, head) {
  let count = 0;
  const most = Math.min(one.length, other.length) - head;
  while (count < most && one[one.length - 1 - count] === other[other.length - 1 - count]) count += 1;
  return count;
}
