// Completion: CUE_WORDS.next holds what the grammar allows after each beginning of a statement (completions.py).

const NEXT = CUE_WORDS.next;
const UNIT_TERMINALS = new Set(["ABSOLUTE", "DIFFERENCE", "RATE", "TIME", "CURRENT", "CURRENT_RATE"]);

/** The context at the end of a text ("file", "set" or "icon"), and the pieces of the statement that it ends in. */
function statementAt(text) {
  const blocks = [];
  let pieces = [];
  for (const line of text.split("\n")) {
    const header = !blocks.length && ["icon", "set"].includes(pieces[0]?.text); // goes on over lines
    if (!header) pieces = [];
    for (const piece of cueTokens(line)) {
      if (piece.kind === "comment") continue;
      if (piece.text === "{") blocks.push(!blocks.length && pieces[0]?.text === "set" ? "set" : "icon");
      if (piece.text === "}") blocks.pop();
      if (["{", "}", ";"].includes(piece.text)) pieces = [];
      else pieces.push(piece);
    }
  }
  return { context: blocks.at(-1) ?? "file", pieces };
}

/** The branches of the grammar behind these pieces, or null where the statement is none of the language. */
function branchesAfter(context, pieces) {
  let tree = NEXT.trees[context];
  for (const { text, kind } of pieces) {
    const step = (name) => {
      if (name === "NUMBER") return kind === "number";
      if (name === "STRING" || name === "TITLE") return kind === "string";
      if (name === "NAME") return /^\p{L}/u.test(text);
      return NEXT.words[name]?.includes(text);
    };
    const names = Object.keys(tree);
    const taken = names.filter((name) => name !== "NAME").find(step) ?? names.find(step);
    if (taken === undefined) return null;
    tree = tree[taken];
  }
  return tree;
}

/** What CodeMirror shows as completions at the caret; null for none. */
function cueCompletions(given) {
  const word = given.matchBefore(/[\p{L}°][\p{L}\p{N}°/-]*/u);
  if (!word && !given.explicit) return null;
  const from = word?.from ?? given.pos;
  const before = given.state.sliceDoc(0, from);
  const last = cueTokens(before.slice(before.lastIndexOf("\n") + 1)).at(-1);
  if (last?.kind === "comment" || (last?.kind === "string" && !/.+"$/.test(last.text))) return null;
  const { context, pieces } = statementAt(before);
  const tree = branchesAfter(context, pieces);
  if (!tree) return null;
  const options = Object.keys(tree).flatMap((name) => optionsOf(name, pieces, given.state.doc.toString()));
  if (!options.length || (!given.explicit && options.some(({ label }) => label === word?.text))) return null;
  return { from, options };
}

function optionsOf(name, pieces, text) {
  if (name === "NAME") return namesFor(pieces.at(-1)?.text, text).map((label) => ({ label, type: "variable" }));
  const words = NEXT.words[name] ?? [];
  const unit = UNIT_TERMINALS.has(name);
  return words.map((label, k) => ({
    label, type: unit ? "unit" : "keyword", boost: unit ? 10 - k : 0, detail: pieces.length ? "" : NEXT.examples[label] ?? "",
  }));
}

/** Names that can stand behind a word: icons to play, ways of control, parameters of families. */
function namesFor(before, text) {
  if (before === "control") return NEXT.controls;
  if (before === "play") return [...text.matchAll(/^\s*icon\s+([^\s({]+)/gm)].map((match) => match[1]);
  if (["by", "to", "at", "over", "for", "every", "repeat"].includes(before)) {
    return [...new Set([...text.matchAll(/[(,]\s*([\p{L}][\p{L}\p{N}-]*)\s+in\s+[[\d+-]/gu)].map((match) => match[1]))];
  }
  return [];
}
