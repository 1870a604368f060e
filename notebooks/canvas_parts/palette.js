// Shapes, and icons of shipped sets, that are put in at the caret as the cue text that they are.

class Palette {
  /** `post` asks for the icons of shipped sets, and to show an icon that was put in. */
  constructor(editor, post, say) {
    Object.assign(this, { editor, post, say, texts: null });
    const shapes = Object.entries(CUE_WORDS.shapes).map(([name, text]) =>
      make("button", { type: "button", class: "tm-shape", onclick: () => this.drop(name, text) }, make("b", {}, name), make("code", {}, text)));
    this.icons = make("select", { class: "tm-select", "aria-label": "Icon of a shipped set" }, make("option", {}, "loading …"));
    this.take = make("button", { type: "button", class: "tm-button", onclick: () => this.takeIcon() }, "Insert icon");
    this.panel = make("div", { class: "tm-palette-panel", hidden: true, id: uniqueId("palette") },
      make("div", { class: "tm-shapes" }, ...shapes), make("div", { class: "tm-palette-icons" }, this.icons, this.take));
    this.button = make("button", {
      type: "button", class: "tm-button", title: "shapes and shipped icons, put in at the caret", "aria-expanded": "false", "aria-controls": this.panel.id,
      onclick: () => this.open(this.panel.hidden),
    }, "Insert ▾");
    this.element = make("div", { class: "tm-palette", onkeydown: (event) => event.key === "Escape" && this.open(false) }, this.button, this.panel);
    this.outside = (event) => !this.element.contains(event.target) && this.open(false);
    document.addEventListener("pointerdown", this.outside, true);
  }

  open(open) {
    const inside = this.panel.contains(document.activeElement);
    this.panel.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    if (!open && inside) this.button.focus();
    if (open && !this.texts) this.post({ type: "palette" });
  }

  /** Sets of the kernel: names with the texts of their icons. */
  show(sets) {
    this.texts = Object.assign({}, ...Object.values(sets));
    const group = ([set, icons]) => make("optgroup", { label: set }, ...Object.keys(icons).map((name) => make("option", { value: name }, name)));
    this.icons.replaceChildren(...Object.entries(sets).map(group));
  }

  takeIcon() {
    const text = this.texts?.[this.icons.value];
    if (text) this.drop(this.icons.value, text);
  }

  /** Puts a shape into the icon of the caret, as statements, or as an icon of its own; and an icon behind that icon. */
  drop(name, text) {
    const { view } = this.editor;
    const doc = view.state.doc.toString();
    const block = blockAt(doc, view.state.selection.main.head);
    const statements = !/^icon\b/.test(text);
    const put = statements && block?.kind !== "set" && block ? within(doc, block, text) : behind(doc, block, view.state.selection.main.head, name, text, statements);
    view.dispatch({ changes: put, selection: { anchor: put.from + put.insert.length }, scrollIntoView: true, userEvent: "input" });
    const fresh = /^\s*icon\s+([^\s({]+)\s*[^(]/.exec(put.insert);
    if (fresh) this.post({ type: "icon", name: fresh[1] });
    this.open(false);
    this.editor.focus();
    this.say(`${name} inserted`);
  }

  stop() {
    document.removeEventListener("pointerdown", this.outside, true);
  }
}

/** The braces around a place of a text: {kind: "set" or "icon", open, close, caret}, of the innermost and outermost; or null. */
function blockAt(text, caret) {
  const masked = text.replace(/#.*|"[^"\n]*"/g, (found) => " ".repeat(found.length));
  const open = [];
  for (let k = 0; k < caret; k += 1) {
    if (masked[k] === "{") open.push(k);
    if (masked[k] === "}") open.pop();
  }
  if (!open.length) return null;
  const head = masked.slice(0, open[0]);
  const kind = head.lastIndexOf("set ") > head.lastIndexOf("icon ") ? "set" : "icon";
  return { kind, caret, open: open.at(-1), close: closing(masked, open.at(-1)), end: closing(masked, open[0]) };
}

/** Where the block that a brace opens is closed; the end of the text where it is not. */
function closing(masked, open) {
  let depth = 0;
  for (let k = open; k < masked.length; k += 1) {
    depth += { "{": 1, "}": -1 }[masked[k]] ?? 0;
    if (depth === 0) return k;
  }
  return masked.length;
}

/** Statements below the line of the caret; in a block of one line, before its end. */
function within(doc, { open, close, caret }, text) {
  if (!doc.slice(open, close).includes("\n")) {
    const from = doc.slice(0, close).trimEnd().length;
    return { from, to: close, insert: `${from > open + 1 ? ";" : ""} ${text.split("\n").join("; ")} ` };
  }
  const begin = doc.lastIndexOf("\n", caret - 1) + 1;
  const end = doc.indexOf("\n", caret) < 0 ? doc.length : doc.indexOf("\n", caret);
  const line = doc.slice(begin, end);
  const inner = open >= begin ? "  " : "";
  const indent = /^[ \t]*/.exec(doc.slice(doc.lastIndexOf("\n", open - 1) + 1))[0];
  const pad = line.trim() ? /^[ \t]*/.exec(line)[0] + inner : `${indent}  `;
  const lines = text.split("\n").map((each) => pad + each).join("\n");
  if (!line.trim()) return { from: begin, to: end, insert: lines };
  return close < end ? { from: begin, to: begin, insert: `${lines.replaceAll(pad, `${indent}  `)}\n` } : { from: end, to: end, insert: `\n${lines}` };
}

/** An icon behind the one of the caret, under a name that is free. */
function behind(doc, block, caret, name, text, statements) {
  const taken = new Set([...doc.matchAll(/^\s*icon\s+([^\s({]+)/gm)].map((match) => match[1]));
  const stem = name.replaceAll(/[^\p{L}\p{N}]+/gu, "-");
  let free = stem;
  for (let k = 2; taken.has(free); k += 1) free = `${stem}-${k}`;
  const whole = statements ? `icon ${free} {\n${text.split("\n").map((each) => `  ${each}`).join("\n")}\n}` : text.replace(name, free);
  const at = block ? block.end + 1 : caret;
  const end = doc.indexOf("\n", at) < 0 ? doc.length : doc.indexOf("\n", at);
  const from = Math.min(end, doc.length);
  const before = doc.slice(0, from);
  return { from, to: from, insert: `${before && !before.endsWith("\n") ? "\n\n" : before ? "\n" : ""}${whole}${from === doc.length ? "\n" : ""}` };
}
