// Colours for the canvases: read from the custom properties of theme.css, and again whenever the theme changes.

const ROLES = ["ink", "grey", "cool", "warm", "target", "limit", "paper", "soft", "grid", "line", "focus"];

/** What the theme says at `root`: a colour for each role, and the font. */
function paletteOf(root) {
  const style = getComputedStyle(root);
  const palette = { font: style.fontFamily };
  for (const role of ROLES) palette[role] = style.getPropertyValue(`--tm-${role}`).trim() || "#888888";
  return palette;
}

let probe = null;

/** Relative luminance (0 to 1, as in WCAG) of any colour that CSS has. */
function luminance(colour) {
  probe ??= Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
  probe.fillStyle = colour;
  probe.fillRect(0, 0, 1, 1);
  const [red, green, blue] = Array.from(probe.getImageData(0, 0, 1, 1).data, (value) => {
    const part = value / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** Where JupyterLab, which has a setting of its own, gives no theme, the system's wish decides. */
function followSystem() {
  const { body } = document;
  if (body.dataset.jpThemeLight !== undefined) return;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const follow = () => {
    body.dataset.jpThemeLight = String(!system.matches);
  };
  system.addEventListener("change", follow);
  follow();
}

/** Knobs as ipywidgets makes them, with names for screen readers, and with one tab stop: brackets go to another knob. */
function tendControls(root) {
  const knobs = root.closest(".thermicon")?.querySelector(".thermicon-knobs");
  const handles = [...(knobs?.querySelectorAll(".noUi-handle") ?? [])];
  const now = handles.find((handle) => handle.tabIndex === 0 && handle.dataset.tended) ?? handles[0];
  for (const knob of knobs?.querySelectorAll(".thermicon-knob") ?? []) {
    const name = knob.querySelector(".widget-html-content")?.textContent.trim();
    for (const control of knob.querySelectorAll(".noUi-handle, select, .widget-readout")) {
      if (name && control.getAttribute("aria-label") !== name) control.setAttribute("aria-label", name);
      const handle = control.classList.contains("noUi-handle");
      const stop = control === now ? 0 : -1;
      if (control.tabIndex !== stop || !control.hasAttribute("tabindex")) control.tabIndex = stop;
      if (!handle || control.dataset.tended) continue;
      Object.assign(control.dataset, { tended: true, lmSuppressShortcuts: true });
      control.title = "[ and ] go to another slider, Enter to its number";
      control.addEventListener("keydown", (event) => onKnobKey(event, control));
    }
  }
}

function onKnobKey(event, handle) {
  const way = { "[": -1, "]": 1 }[event.key];
  if (event.key === "Enter") handle.closest(".thermicon-knob").querySelector(".widget-readout")?.focus();
  else if (!way) return;
  event.preventDefault();
  event.stopPropagation();
  if (!way) return;
  const all = [...handle.closest(".thermicon-knobs").querySelectorAll(".noUi-handle")];
  const next = all[(all.indexOf(handle) + way + all.length) % all.length];
  for (const each of all) each.tabIndex = each === next ? 0 : -1;
  next.focus();
}

/** Calls `act` when the theme of the page changes; returns how to stop. */
function watchTheme(act) {
  const observer = new MutationObserver(act);
  const attributes = ["data-jp-theme-light", "data-jp-theme-name", "class", "style", "data-theme"];
  for (const place of [document.body, document.documentElement]) {
    observer.observe(place, { attributes: true, attributeFilter: attributes });
  }
  return () => observer.disconnect();
}
