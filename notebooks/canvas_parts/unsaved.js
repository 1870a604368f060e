// The newest text, kept in the page's session for the bench that is made anew after a restart of the kernel: what was
// typed when no kernel was there, which offers it with what kernels before it wrote. A bench finds what belongs to it by
// the text that it begins with.

const KEPT = "thermicon kept";

/** A note of this session, or null; a page may be forbidden to keep any. */
function recall(name) {
  try {
    return sessionStorage.getItem(`${KEPT} ${name}`);
  } catch {
    return null;
  }
}

/** Keeps a note for this session; false where that is forbidden. */
function retain(name, text) {
  try {
    sessionStorage.setItem(`${KEPT} ${name}`, text);
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
  /** `id` tells one model of the kernel from another; `onLeft(text)` takes what an earlier one left. */
  constructor(id, onLeft) {
    Object.assign(this, { model: `model ${id}`, place: null, newest: null, works: true, onLeft });
  }

  /** Takes note of the text that stands in the editor; the first says where in the session its successors are kept. */
  note(text) {
    if (this.place === null) this.begin(text);
    else if (text !== this.newest) this.works = retain(this.place, text) && retain(this.model, this.place);
    this.newest = text;
  }

  /** A model that this session knows goes on in its own place; another one finds what was kept there. */
  begin(text) {
    const known = recall(this.model);
    this.place = known ?? `text ${location.pathname} ${markOf(text)}`;
    const before = known === null ? recall(this.place) : null;
    if (before !== null && before !== text) {
      this.onLeft(before);
      retain(this.place, text); // from now on the kernel has it
    }
    this.works = retain(this.model, this.place);
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
