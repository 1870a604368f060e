// What the workbench takes of CodeMirror; build.sh makes codemirror.js of it.

export { EditorState, StateEffect, StateField, Compartment, Prec, Annotation, Transaction } from "@codemirror/state";
export {
  EditorView, Decoration, ViewPlugin, keymap, lineNumbers, highlightActiveLine, highlightActiveLineGutter,
  highlightSpecialChars, drawSelection, dropCursor, rectangularSelection, crosshairCursor, gutterLineClass, GutterMarker,
  placeholder, tooltips,
} from "@codemirror/view";
export { defaultKeymap, indentWithTab, insertNewlineAndIndent, toggleComment } from "@codemirror/commands";
export { bracketMatching, indentUnit } from "@codemirror/language";
export { setDiagnostics, lintGutter, lintKeymap, nextDiagnostic, forEachDiagnostic } from "@codemirror/lint";
export {
  autocompletion, completionKeymap, closeBrackets, closeBracketsKeymap, startCompletion, completionStatus, acceptCompletion,
} from "@codemirror/autocomplete";
export { search, searchKeymap, highlightSelectionMatches, openSearchPanel } from "@codemirror/search";
