// The newest text, kept in the page's session for the bench that is made anew after a restart of the kernel or, under
// Voila, a reload. A bench finds what belongs to it by the text that it begins with.

const KEPT = "thermicon kept";

/** A note of this session, or null; a page may be forbidden to keep any. */
function recall(name) {
  try {
    return sessionStorage.getItem(`${KEPT} ${name}`);
  } catch {
    return null;
  }
}

/** Keeps a note for this session (null: drops it); false where that is forbidden. */
function retain(name, text) {
  try {
    if (text === null) sessionStorage.removeItem(`${KEPT} ${name}`);
    else sessionStorage.setItem(`${KEPT} ${name}`, text);
    return true;
  } catch {
    return false;
  }
}

/** A short mark of a text: texts with the same mark are taken for the same source. */
function markOf(text) {
  let mark = 0;
  for (let k = 0; k < text.length; k += 1) mark = (Math.imul(mark, 31) + text.charCodeAt(k)) | 0;
  return `${text.length} ${mark >>> 0}`;
}

class UnsavedText {
  /** `id` tells one model of the kernel from another; `onTake(text)` and `onForget()` do what the buttons say, `tell` the kernel. */
  constructor(id, onTake, onForget, say, tell) {
    Object.assign(this, { model: `model ${id}`, place: null, newest: null, offered: null, works: true, say, tell });
    const button = (name, act) => make("button", { type: "button", class: "tm-button", onclick: act }, name);
    this.element = make(
      "div", { class: "tm-unsaved", role: "group", "aria-label": "Earlier text", hidden: true },
      make("span", {}, "An earlier text was saved:"),
      button("Restore it", () => onTake(this.offered)), button("Discard", onForget),
    );
  }

  /** Takes note of the text that stands in the editor; the first says where in the session its successors are kept. */
  note(text) {
    if (this.place === null) this.begin(text);
    else if (text !== this.newest) {
      this.newest = text;
      this.close();
      this.works = retain(this.place, text) && retain(this.model, this.place);
    }
  }

  /** A model that this session knows goes on with its own text; another one may take back what was kept. */
  begin(text) {
    const known = recall(this.model);
    this.newest = text;
    this.place = known ?? `text ${location.pathname} ${markOf(text)}`;
    const before = known === null ? recall(this.place) : null;
    if (before === null || before === text) this.works = retain(this.model, this.place); // undecided, it asks again
    else this.offer(before);
  }

  offer(text) {
    this.offered = text;
    this.element.hidden = false;
    this.tell("kept"); // the kernel may offer what it kept itself, which is older
    const said = "An earlier text was saved. Buttons above the editor restore or discard it.";
    setTimeout(() => this.offered !== null && this.say(said), 0); // after what the first frame says
  }

  forget() {
    retain(this.place, null);
    retain(this.model, this.place);
    this.close();
  }

  close() {
    if (this.offered !== null) this.tell("decided");
    this.offered = null;
    this.element.hidden = true;
  }
}

/** The text on the clipboard; true if it is there. Where pages may not write to it, it is selected and copied the old way. */
async function copyText(editor) {
  try {
    await navigator.clipboard.writeText(editor.text);
    return true;
  } catch {
    editor.selectAll();
    return document.execCommand("copy");
  }
}
