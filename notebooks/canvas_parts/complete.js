// Completion: units behind a number, names behind "play", else words of the language with an example of each statement;
// where a new icon may begin, its word is the first.

/** What CodeMirror shows as completions at the caret; null for none. */
function cueCompletions(given) {
  const word = given.matchBefore(/[\p{L}°][\p{L}\p{N}°/-]*/u);
  if (!word && !given.explicit) return null;
  const from = word?.from ?? given.pos;
  const before = given.state.sliceDoc(0, from);
  const last = cueTokens(before.slice(before.lastIndexOf("\n") + 1)).at(-1);
  const inside = last?.kind === "comment" || (last?.kind === "string" && !/.+"$/.test(last.text));
  if (inside || last?.text === "icon") return null; // a new name is not one of the words
  const [opened, closed] = ["{", "}"].map((brace) => before.replace(/#.*/g, "").split(brace).length);
  const options = optionsBehind(last, given.state.doc.toString(), !last && opened === closed);
  if (!given.explicit && options.some(({ label }) => label === word?.text)) return null;
  return { from, options };
}

function optionsBehind(last, text, begins) {
  if (last?.kind === "number") return CUE_WORDS.units.map((label) => ({ label, type: "unit" }));
  if (last?.text === "play") {
    return [...text.matchAll(/^\s*icon\s+([^\s({]+)/gm)].map((match) => ({ label: match[1], type: "variable" }));
  }
  return CUE_WORDS.keywords.map((label) => ({
    label, type: "keyword", detail: CUE_WORDS.examples[label] ?? "", boost: begins && label === "icon" ? 9 : 0,
  }));
}
