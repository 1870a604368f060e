// What JupyterLab loads to colour `.cue` files: a container as its loader expects one, so that no build step is needed.
// CodeMirror and the registries are JupyterLab's own, from the modules that it shares.

const MIME = "text/x-thermicon-cue";
const TAGS = { comment: "comment", string: "string", number: "number", unit: "unit", keyword: "keyword", name: "def" };
let shared = {};

/** The newest of the versions that JupyterLab shares of a package, or null. */
async function packageOf(name) {
  const versions = Object.entries(shared[name] ?? {});
  const newest = versions.sort(([a], [b]) => a.localeCompare(b, undefined, { numeric: true })).at(-1);
  return newest ? (await newest[1].get())() : null;
}

/** One line at a time, by the tokens of the workbench. */
const PARSER = {
  name: "thermicon-cue",
  token(stream) {
    const piece = cueTokens(stream.string).find(({ from, text }) => from + text.length > stream.pos);
    if (!piece || piece.from > stream.pos) {
      stream.pos = piece ? piece.from : stream.string.length;
      return null;
    }
    stream.pos = piece.from + piece.text.length;
    return TAGS[piece.kind] ?? null;
  },
  languageData: { commentTokens: { line: "#" }, closeBrackets: { brackets: ["{", "[", '"'] } },
};

async function plugin() {
  const [codemirror, language] = [await packageOf("@jupyterlab/codemirror"), await packageOf("@codemirror/language")];
  return {
    id: "thermicon-cue:plugin",
    autoStart: true,
    optional: codemirror ? [codemirror.IEditorLanguageRegistry] : [],
    activate: (app, languages) => {
      if (!languages || !language) return; // a page without an editor
      app.docRegistry?.addFileType({
        name: "thermicon-cue", displayName: "Cue File", extensions: [".cue"], mimeTypes: [MIME], fileFormat: "text", contentType: "file",
      });
      const load = async () => new language.LanguageSupport(language.StreamLanguage.define(PARSER));
      languages.addLanguage({ name: "thermicon-cue", displayName: "Cue", mime: MIME, extensions: ["cue"], load });
    },
  };
}

const ENTRY = {
  init: (scope) => void (shared = scope),
  get: async () => {
    const made = { __esModule: true, default: await plugin() };
    return () => made;
  },
};
(globalThis._JUPYTERLAB ??= {})["thermicon-cue"] = ENTRY;
