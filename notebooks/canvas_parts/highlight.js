// Colours for cue text, line by line: no text of the language goes over several lines. CUE_WORDS comes from canvas.py,
// which takes keywords and units from the language itself.

const NUMBER_PATTERN = "[+\\-\\u2212]?(?:[0-9]+(?:\\.(?!\\.)[0-9]*)?|\\.[0-9]+)(?:[eE][+\\-\\u2212]?[0-9]+)?";
const UNIT_PATTERN = CUE_WORDS.units.map((unit) => unit.replace(/[/.*+?^$|()[\]{}]/g, "\\$&")).join("|");
const CUE_TOKEN = new RegExp(
  `(?<comment>#.*)|(?<string>"(?:[^"\\\\]|\\\\.)*"?)|(?<number>${NUMBER_PATTERN})|(?<unit>(?:${UNIT_PATTERN})(?![\\p{L}\\p{N}/-]))` +
    `|(?<word>\\p{L}[\\p{L}\\p{N}-]*(?:_\\p{L}[\\p{L}\\p{N}-]*=-?[0-9.]+)*)|(?<mark>\\.\\.|[{}();,\\[\\]])`,
  "gu",
);
const CUE_KEYWORDS = new Set(CUE_WORDS.keywords);
const NAME_AFTER = new Set(["icon", "play", "set", "site", "control"]);

/** Pieces of a line in order, {text, kind, from}; what no piece covers is blank or unknown. */
function cueTokens(line) {
  const pieces = [];
  let before = "";
  for (const match of line.matchAll(CUE_TOKEN)) {
    const [kind, text] = Object.entries(match.groups).find(([, part]) => part !== undefined);
    pieces.push({ text, kind: kindOf(kind, text, before), from: match.index });
    before = kind === "number" ? "number" : text;
  }
  return pieces;
}

function kindOf(kind, text, before) {
  if (kind === "unit") return before === "number" || before === "]" ? "unit" : CUE_KEYWORDS.has(text) ? "keyword" : "plain";
  if (kind !== "word") return kind;
  if (NAME_AFTER.has(before)) return "name";
  return CUE_KEYWORDS.has(text) ? "keyword" : "plain";
}

/** Where a column (1-based, counted in characters as Python does) begins in a JavaScript string. */
function offsetOf(line, column) {
  return Array.from(line).slice(0, Math.max(0, column - 1)).join("").length;
}

/** The extension that colours the lines in sight. */
function cueColours() {
  const looks = {};
  const lookOf = (kind) => (looks[kind] ??= CM.Decoration.mark({ class: `tm-${kind}` }));
  const painted = (view) => {
    const marks = [];
    for (const { from, to } of view.visibleRanges) {
      for (let at = from; at <= to; ) {
        const line = view.state.doc.lineAt(at);
        for (const { text, kind, from: start } of cueTokens(line.text)) {
          if (kind !== "plain") marks.push(lookOf(kind).range(line.from + start, line.from + start + text.length));
        }
        at = line.to + 1;
      }
    }
    return CM.Decoration.set(marks);
  };
  return CM.ViewPlugin.define(
    (view) => ({
      decorations: painted(view),
      update(change) {
        if (change.docChanged || change.viewportChanged) this.decorations = painted(change.view);
      },
    }),
    { decorations: (plugin) => plugin.decorations },
  );
}
