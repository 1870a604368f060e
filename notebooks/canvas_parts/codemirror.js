// CodeMirror, which the text side is made of: one committed ES module (notebooks/codemirror), that canvas.py packs into
// PACKED_CODEMIRROR, so that a notebook which stores its widgets stays small. CM is what it exports.

let CM = null;
let loading = null;

/** Loads CodeMirror once for this module. */
function loadCodeMirror() {
  loading ??= (async () => {
    const packed = Uint8Array.from(atob(PACKED_CODEMIRROR), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const script = new Blob([await new Response(stream).arrayBuffer()], { type: "text/javascript" });
    const address = URL.createObjectURL(script);
    try {
      CM = await import(/* webpackIgnore: true */ address);
    } finally {
      URL.revokeObjectURL(address);
    }
  })();
  return loading;
}
