// The cue text: CodeMirror with the colours, errors and completion of the language. Undo and redo belong to the kernel,
// since a step may be a drag or an edit taken over in the set view.

class Editor {
  /** `onText(text)`, `onCaret(icon)`, `onCommand("undo")` and `onApply(line)` get what the person does; tooltips go into `root`. */
  constructor(root, { onText, onCaret, onCommand, onApply }) {
    Object.assign(this, { root, onText, onCaret, onCommand, livePlace: 0 });
    this.outside = CM.Annotation.define(); // marks changes that are not typed here
    this.troubles = new Troubles(this, onApply);
    const host = make("div", { class: "tm-code" });
    this.element = make("div", { class: "tm-editor" }, host, this.troubles.status);
    this.view = new CM.EditorView({ parent: host, state: CM.EditorState.create({ doc: "", extensions: this.extensions() }) });
    this.element.editor = this; // for tests, and for whoever looks into the page
  }

  extensions() {
    const keys = [
      { key: "Mod-.", run: () => this.troubles.cureHere(), preventDefault: true },
      { key: "Tab", run: CM.acceptCompletion },
      ...CM.closeBracketsKeymap, ...CM.defaultKeymap, ...CM.searchKeymap, ...CM.completionKeymap, ...CM.lintKeymap,
    ];
    return [
      CM.lineNumbers({ domEventHandlers: { mousedown: (view, line) => this.onNumber(line) } }), this.liveLine(), CM.lintGutter(),
      CM.EditorView.lineWrapping, CM.highlightActiveLine(), CM.highlightSpecialChars(), CM.drawSelection(), CM.dropCursor(),
      CM.bracketMatching(), CM.closeBrackets(), CM.highlightSelectionMatches(), CM.search({ top: true }),
      CM.EditorState.allowMultipleSelections.of(true), CM.EditorState.tabSize.of(4), CM.indentUnit.of("  "),
      CM.EditorState.languageData.of(() => [{ commentTokens: { line: "#" }, closeBrackets: { brackets: ["(", "[", "{", '"'] } }]),
      CM.autocompletion({ override: [cueCompletions], icons: false, maxRenderedOptions: 40 }),
      CM.tooltips({ parent: this.root, position: "absolute" }), cueColours(),
      CM.EditorView.editorAttributes.of({ "data-lm-suppress-shortcuts": "true" }),
      CM.EditorView.contentAttributes.of(() => ({
        tabindex: "0", "aria-label": "Cue text", "aria-describedby": this.troubles.status.id, "aria-invalid": String(this.troubles.list.length > 0),
      })),
      CM.Prec.high(CM.keymap.of([{ key: "Enter", run: (view) => this.breakLine(view) }])),
      CM.keymap.of(keys),
      CM.Prec.highest(CM.EditorView.domEventHandlers({ keydown: (event) => this.onKey(event) })),
      CM.EditorView.updateListener.of((change) => this.onChange(change)),
    ];
  }

  get text() {
    return this.view.state.doc.toString();
  }

  focus() {
    this.view.focus();
  }

  selectAll() {
    this.view.dispatch({ selection: { anchor: 0, head: this.view.state.doc.length } });
    this.focus();
  }

  onChange(change) {
    if (change.docChanged && !change.transactions.some((each) => each.annotation(this.outside))) this.onText(this.text);
    if (change.docChanged || change.selectionSet) this.troubles.sayStatus();
    const placed = change.transactions.some((each) => each.isUserEvent("select")); // by a person: click or keys
    if (placed && change.state.selection.main.empty) this.onCaret(this.iconHere);
  }

  /** The icon or family that the caret stands in, or below; null above the first and in the set. */
  get iconHere() {
    const { doc, selection } = this.view.state;
    for (let k = doc.lineAt(selection.main.head).number; k > 0; k -= 1) {
      const [, kind, name] = /^\s*(icon|set)\s+([^\s({]+)/.exec(doc.line(k).text) ?? [];
      if (kind) return kind === "icon" ? name : null;
    }
    return null;
  }

  /** Puts in a text from the kernel; caret and scrolling stay with the words around them. */
  replace(text) {
    const old = this.text;
    const fresh = asHeld(text);
    if (fresh === old) return;
    const head = commonHead(old, fresh);
    const tail = commonTail(old, fresh, head);
    const changes = { from: head, to: old.length - tail, insert: fresh.slice(head, fresh.length - tail) };
    this.view.dispatch({ changes, annotations: this.outside.of(true) });
  }

  show(troubles) {
    this.troubles.takeList(troubles);
  }

  /** The line that a corner on the time line belongs to, marked in text and gutter. */
  liveLine() {
    this.setLive = CM.StateEffect.define();
    const mark = CM.Decoration.line({ class: "tm-live" });
    return CM.StateField.define({
      create: () => CM.Decoration.none,
      update: (marks, change) => {
        const told = change.effects.find((effect) => effect.is(this.setLive));
        if (!told) return marks.map(change.changes);
        const { doc } = change.state;
        return told.value >= 1 && told.value <= doc.lines ? CM.Decoration.set(mark.range(doc.line(told.value).from)) : CM.Decoration.none;
      },
      provide: (field) => CM.EditorView.decorations.from(field),
    });
  }

  /** Shows which line a corner belongs to (0: none), and scrolls there if `follow`. */
  pointAt(line, follow) {
    if (line !== this.livePlace) {
      this.livePlace = line;
      this.view.dispatch({ effects: this.setLive.of(line) });
    }
    if (follow && line && line !== this.followed) this.reveal(line, "nearest");
    this.followed = follow ? line : 0;
  }

  /** Scrolls the text alone: CodeMirror's own way would scroll the page around it too. */
  reveal(line, y = "center") {
    const { doc } = this.view.state;
    const { from } = doc.line(clamp(line, 1, doc.lines));
    const scroller = this.view.scrollDOM;
    const scroll = () => {
      const { top, bottom } = this.view.lineBlockAt(from);
      const [above, high] = [scroller.scrollTop, scroller.clientHeight];
      if (y === "nearest" && top >= above && bottom <= above + high) return;
      scroller.scrollTop = y === "center" || (y === "nearest" && bottom > above + high) ? (top + bottom - high) / 2 : top - 20;
    };
    scroll();
    requestAnimationFrame(scroll); // lines that were out of sight have their true heights now
  }

  /** Scrolls to where an icon, or the family that it belongs to, begins. */
  revealIcon(name) {
    const words = this.text.split("\n").map((line) => /^\s*icon\s+([^\s({]+)/.exec(line)?.[1]);
    const exact = words.indexOf(name);
    const line = exact < 0 ? words.findIndex((word) => word && name?.startsWith(`${word}_`)) : exact;
    if (line >= 0) this.reveal(line + 1, "start");
  }

  /** Offset of a place counted from 1, in characters as Python counts them. */
  placeOf(line, column) {
    const { doc } = this.view.state;
    const row = doc.line(clamp(line, 1, doc.lines));
    return row.from + Math.min(offsetOf(row.text, column), row.length);
  }

  goTo(line, column) {
    const anchor = this.placeOf(line, column);
    this.view.dispatch({ selection: { anchor } });
    this.reveal(line);
    this.focus();
  }

  /** A click on a line number keeps the focus in the text: elsewhere, JupyterLab takes letters as commands on cells. */
  onNumber(line) {
    this.view.dispatch({ selection: { anchor: this.view.state.doc.lineAt(line.from).from } });
    this.focus();
    return true;
  }

  /** Undo, redo and saving are the workbench's; the page around, a notebook, is saved by the same keystroke. */
  onKey(event) {
    const command = commandOf(event);
    if (!command) return false;
    event.preventDefault();
    this.onCommand(command);
    if (command === "save") passOn(event, this.element);
    return true;
  }

  /** A new line begins where the line before began, two further inside of a block. */
  breakLine(view) {
    const { state } = view;
    const { from, to } = state.selection.main;
    if (state.selection.ranges.length > 1 || CM.completionStatus(state) === "active") return false;
    const before = state.doc.lineAt(from).text.slice(0, from - state.doc.lineAt(from).from);
    const indent = /^[ \t]*/.exec(before)[0];
    const deeper = /\{\s*(#.*)?$/.test(before) ? "  " : "";
    const closes = deeper && state.sliceDoc(to, to + 1) === "}" ? `\n${indent}` : "";
    const insert = `\n${indent}${deeper}`;
    view.dispatch({ changes: { from, to, insert: insert + closes }, selection: { anchor: from + insert.length }, scrollIntoView: true, userEvent: "input" });
    return true;
  }

  stop() {
    this.view.destroy();
  }
}

/** A text as CodeMirror holds it. */
function asHeld(text) {
  return text.replace(/\r\n?/g, "\n");
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
