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

/** Pieces of a line in order, {text, kind}; together they are the whole line. */
function cueTokens(line) {
  const pieces = [];
  let end = 0;
  let before = "";
  for (const found of line.matchAll(CUE_TOKEN)) {
    const [kind, text] = Object.entries(found.groups).find(([, part]) => part !== undefined);
    if (found.index > end) pieces.push({ text: line.slice(end, found.index), kind: "" });
    pieces.push({ text, kind: kindOf(kind, text, before) });
    end = found.index + text.length;
    before = kind === "number" ? "number" : text;
  }
  if (end < line.length) pieces.push({ text: line.slice(end), kind: "" });
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

/** Cuts pieces at the ends of [from, to) and sets `wrong` on what lies inside. */
function markWrong(pieces, from, to) {
  let at = 0;
  return pieces.flatMap((piece) => {
    const begin = at;
    at += piece.text.length;
    const cuts = [0, clamp(from - begin, 0, piece.text.length), clamp(to - begin, 0, piece.text.length), piece.text.length];
    const part = (k, wrong) => ({ ...piece, text: piece.text.slice(cuts[k], cuts[k + 1]), wrong: wrong || piece.wrong });
    return [part(0, false), part(1, true), part(2, false)].filter((cut) => cut.text);
  });
}

/** The elements of one line, with wavy marks under what the troubles of this line are about. */
function lineElements(line, troubles) {
  let pieces = cueTokens(line);
  for (const trouble of troubles) {
    const from = Math.min(offsetOf(line, trouble.column), line.length);
    const to = Math.max(offsetOf(line, trouble.end_column ?? trouble.column + 1), from + 1);
    if (from >= line.length) pieces.push({ text: " ", kind: "", wrong: true }); // something is missing at the end
    else pieces = markWrong(pieces, from, to);
  }
  return pieces.map(({ text, kind, wrong }) => {
    const look = [kind && `tm-${kind}`, wrong && "tm-wrong"].filter(Boolean).join(" ");
    return look ? make("span", { class: look }, text) : document.createTextNode(text);
  });
}
