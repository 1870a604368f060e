// Errors in small print under their lines; the whole of one, with its hint and its cure, on hover, focus or click.

const LEAVE_MS = 250;

class Troubles {
  constructor(editor, onApply) {
    Object.assign(this, { editor, onApply, list: [], items: [], opened: null, timer: 0 });
    this.element = make("div", { class: "tm-troubles" });
  }

  take(troubles) {
    if (JSON.stringify(troubles) === JSON.stringify(this.list)) return;
    this.list = troubles;
    this.close();
    this.items = [...this.byLine()].map(([line, all]) => this.makeItem(line, all));
    this.element.replaceChildren(...this.items.map((item) => item.element));
    this.sayStatus();
  }

  /** Troubles by the line they belong to, in the order of the lines. */
  byLine() {
    const found = new Map();
    for (const trouble of [...this.list].sort((one, other) => one.line - other.line)) {
      found.set(trouble.line, [...(found.get(trouble.line) ?? []), trouble]);
    }
    return found;
  }

  makeItem(line, all) {
    const more = make("div", { class: "tm-more", id: uniqueId("hint"), hidden: true }, ...all.flatMap((one) => this.explained(one)));
    const rest = all.length > 1 ? make("span", { class: "tm-count" }, ` +${all.length - 1}`) : null;
    const head = make(
      "button",
      { class: "tm-trouble", type: "button", "aria-expanded": "false", "aria-controls": more.id, "aria-label": `Line ${line}: ${all[0].code} ${all[0].headline}` },
      make("b", {}, all[0].code), ` ${all[0].headline}`, rest,
    );
    const element = make("div", { class: "tm-trouble-place", "data-line": line }, head, more);
    const item = { line, column: all[0].column, element, head, more };
    this.listen(item);
    return item;
  }

  explained(trouble) {
    const full = make("p", { class: "tm-headline" }, make("b", {}, trouble.code), ` ${trouble.headline}`);
    const hint = trouble.hint ? make("p", { class: "tm-hint" }, trouble.hint) : null;
    const take = trouble.suggestion
      ? make("button", { class: "tm-take", type: "button", onclick: () => this.apply(trouble.line) },
          make("span", { class: "tm-take-word" }, "take: "), make("code", {}, trouble.suggestion.trim()))
      : null;
    return [full, hint, take].filter(Boolean);
  }

  apply(line) {
    this.close();
    this.editor.area.focus({ preventScroll: true });
    this.onApply(line);
  }

  listen(item) {
    const { element, head } = item;
    element.addEventListener("pointerenter", () => this.open(item));
    element.addEventListener("pointerleave", () => this.closeSoon());
    head.addEventListener("click", () => this.open(item));
    element.addEventListener("focusin", () => this.open(item));
    element.addEventListener("focusout", () => this.closeSoon());
    element.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      head.focus();
      this.close();
    });
  }

  open(item) {
    clearTimeout(this.timer);
    if (this.opened === item) return;
    this.close();
    this.opened = item;
    item.more.hidden = false;
    item.head.setAttribute("aria-expanded", "true");
    item.element.classList.add("tm-open");
    this.placeMore(item);
  }

  closeSoon() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (!this.opened?.element.matches(":hover, :focus-within")) this.close();
    }, LEAVE_MS);
  }

  close() {
    clearTimeout(this.timer);
    if (!this.opened) return;
    this.opened.more.hidden = true;
    this.opened.head.setAttribute("aria-expanded", "false");
    this.opened.element.classList.remove("tm-open");
    this.opened = null;
  }

  /** Puts each message under its line, beginning under the wrong place where there is room to the right. */
  place() {
    if (!this.items.length) return;
    const { scroller, backdrop, gutter } = this.editor;
    const room = scroller.clientWidth - gutter.offsetWidth - 8;
    if (room < 40) return;
    const places = this.items.map((item) => {
      const line = backdrop.children[Math.min(item.line, backdrop.children.length) - 1];
      const wrong = line?.querySelector(".tm-wrong");
      item.element.style.maxWidth = `${room}px`;
      return { item, from: wrong ? line.offsetLeft + wrong.offsetLeft - 3 : 8, wide: item.head.scrollWidth };
    });
    for (const { item, from, wide } of places) {
      const left = from + wide <= room ? from : Math.max(6, Math.min(from, room - wide));
      item.element.style.left = `${left}px`;
      item.element.style.maxWidth = `${Math.max(room - left, 60)}px`;
      item.element.style.top = `${TOP_PX + item.line * LINE_PX - 5}px`;
    }
  }

  /** The explanation goes below its message, or above the line where the view ends. */
  placeMore({ element, more, line }) {
    const { scroller, gutter } = this.editor;
    const room = scroller.clientWidth - gutter.offsetWidth - 16;
    const wide = Math.min(420, room);
    more.style.width = `${wide}px`;
    more.style.left = `${Math.min(0, room + scroller.scrollLeft - element.offsetLeft - wide)}px`;
    const below = TOP_PX + line * LINE_PX + 10 - scroller.scrollTop + more.offsetHeight <= scroller.clientHeight;
    const fits = line * LINE_PX - LINE_PX - more.offsetHeight > scroller.scrollTop;
    more.classList.toggle("tm-above", !below && fits);
  }

  /** The line below the text: how many errors there are, and a way to the first. */
  sayStatus() {
    const { status } = this.editor;
    status.replaceChildren();
    status.classList.toggle("tm-has-errors", this.list.length > 0);
    this.editor.area.setAttribute("aria-invalid", this.list.length > 0);
    if (!this.list.length) return status.append("no errors");
    const [line, all] = this.byLine().entries().next().value;
    const count = this.list.length === 1 ? "1 error" : `${this.list.length} errors`;
    const go = make("button", { type: "button", class: "tm-go", onclick: () => this.editor.goTo(line, all[0].column) }, `${count}, line ${line}`);
    status.append(go, make("span", { class: "tm-first" }, `${all[0].code} ${all[0].headline}`));
  }

  stop() {
    clearTimeout(this.timer);
  }
}
