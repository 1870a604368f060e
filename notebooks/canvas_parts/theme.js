// Colours for the canvases: read from the custom properties of theme.css, and again whenever the theme changes.

const ROLES = ["ink", "grey", "cool", "warm", "target", "limit", "paper", "soft", "grid", "line", "focus"];

/** What the theme says at `root`: a colour for each role, and the font. */
function paletteOf(root) {
  const style = getComputedStyle(root);
  const palette = { font: style.fontFamily };
  for (const role of ROLES) palette[role] = style.getPropertyValue(`--tm-${role}`).trim() || "#888888";
  return palette;
}

/** Calls `act` when JupyterLab's theme, the system's theme or the pixel ratio changes; returns how to stop. */
function watchTheme(act) {
  const observer = new MutationObserver(act);
  const attributes = ["data-jp-theme-light", "data-jp-theme-name", "class", "style", "data-theme"];
  for (const place of [document.body, document.documentElement]) {
    observer.observe(place, { attributes: true, attributeFilter: attributes });
  }
  const system = matchMedia("(prefers-color-scheme: dark)");
  system.addEventListener("change", act);
  return () => {
    observer.disconnect();
    system.removeEventListener("change", act);
  };
}
