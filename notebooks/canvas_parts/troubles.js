// Errors of the text: wavy marks and signs in the gutter with the cure as an action (CodeMirror's lint), and below the
// text, in words, the error of the caret's line or the first.

class Troubles {
  constructor(editor, onApply) {
    Object.assign(this, { editor, onApply, list: [], looks: "" });
    this.go = make("button", { type: "button", class: "tm-go", title: "go to the error (F8: the next)", onclick: () => this.goThere() });
    this.first = make("span", { class: "tm-first" });
    this.take = make("button", { type: "button", class: "tm-take", title: "take this correction (Ctrl+.)", onclick: () => this.apply(this.shown) });
    this.status = make("div", { class: "tm-status", id: uniqueId("status") }, "no errors");
  }

  takeList(troubles) {
    if (!troubles.length && !this.list.length) return;
    this.list = [...troubles].sort((one, other) => one.line - other.line);
    const { view } = this.editor;
    view.dispatch(CM.setDiagnostics(view.state, this.list.map((trouble) => this.diagnosticOf(trouble))));
    this.sayStatus();
  }

  diagnosticOf(trouble) {
    const { editor } = this;
    const from = editor.placeOf(trouble.line, trouble.column);
    const to = Math.max(from, editor.placeOf(trouble.line, trouble.end_column ?? trouble.column + 1));
    const message = `${trouble.code} ${trouble.headline}`;
    const hint = trouble.hint ? make("p", { class: "tm-hint" }, trouble.hint) : "";
    return {
      from, to, message, severity: "error", source: "",
      renderMessage: () => make("div", {}, make("p", { class: "tm-headline" }, make("b", {}, trouble.code), ` ${trouble.headline}`), hint),
      actions: trouble.suggestion ? [{ name: `take: ${trouble.suggestion.trim()}`, apply: () => this.apply(trouble) }] : [],
    };
  }

  apply(trouble) {
    if (!trouble?.suggestion) return;
    this.editor.focus();
    this.onApply(trouble.line);
  }

  goThere() {
    if (this.shown) this.editor.goTo(this.shown.line, this.shown.column);
  }

  /** Takes the correction of the caret's line, or the only one there is; false where there is none. */
  cureHere() {
    this.apply(this.shown);
    return Boolean(this.shown?.suggestion);
  }

  /** The line below the text: how many errors there are, and the one of the caret's line, or the first. */
  sayStatus() {
    const { state } = this.editor.view;
    const line = state.doc.lineAt(state.selection.main.head).number;
    const here = this.list.find((trouble) => trouble.line === line);
    this.shown = here ?? this.list[0] ?? null;
    const looks = JSON.stringify([this.shown, this.list.length]);
    if (looks === this.looks) return;
    this.looks = looks;
    this.status.classList.toggle("tm-has-errors", this.list.length > 0);
    if (!this.shown) return this.status.replaceChildren("no errors");
    const { code, headline, suggestion } = this.shown;
    const count = this.list.length === 1 ? "1 error" : `${this.list.length} errors`;
    setText(this.go, `${count}, line ${this.shown.line}`);
    setText(this.first, `${code} ${headline}`);
    this.first.title = `${code} ${headline}`;
    setText(this.take, suggestion ? `take: ${suggestion.trim()}` : "");
    this.status.replaceChildren(this.go, this.first, ...(suggestion ? [this.take] : []));
  }
}
