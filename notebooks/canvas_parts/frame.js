// A frame as it comes from the kernel, made safe to draw: floats out of buffers, and every list there.

/** Float32Array of a buffer; a DataView need not begin at a multiple of four bytes, and is copied then. */
function floatsOf(buffer) {
  if (!ArrayBuffer.isView(buffer)) return new Float32Array(buffer);
  const { buffer: whole, byteOffset, byteLength } = buffer;
  if (byteOffset % 4 === 0) return new Float32Array(whole, byteOffset, byteLength >> 2);
  return new Float32Array(whole.slice(byteOffset, byteOffset + (byteLength & ~3)));
}

function seriesOf(given) {
  return { key: given.label, role: "ink", dash: [], width: 1.5, step: false, ...given };
}

function panelOf(given) {
  const panel = { height: 1, digits: 4, terms: [], levels: [], spans: [], marks: [], ...given };
  const [series, pinned] = [given.series ?? [], given.pinned ?? []].map((all) => all.map(seriesOf));
  return { ...panel, series, pinned, unit: unitOf(given.label ?? "") };
}

/** The frame of a "design" or "traces" view. */
function tracesFrame(meta, buffers) {
  const defaults = {
    seq: 0, text: null, of: "", icons: [], icon: null, troubles: [], stale: false, can_undo: false, can_redo: false,
    badge: { colour: "grey", text: "", more: [] }, notes: [], time: { t0: 0, dt: 1, n: 0 }, handles: [], pinned: null, ms: null,
  };
  const frame = { ...defaults, ...meta, arrays: (buffers ?? []).map(floatsOf) };
  frame.panels = (meta.panels ?? []).map(panelOf);
  const endOf = ({ t0, dt, n }) => (n > 1 && dt > 0 ? t0 + dt * (n - 1) : t0 + 1);
  frame.end = endOf(frame.time);
  if (frame.pinned) frame.pinned = { ...frame.pinned, end: endOf(frame.pinned) };
  frame.play = { until: frame.end, felt: false, onset: Infinity, quality: "", share: null, ...meta.play };
  return frame;
}

/** The value of a series at a time, or NaN: between rows, a step keeps the earlier one. */
function valueAt(values, time, t, step) {
  const row = (t - time.t0) / time.dt;
  const last = Math.min(values.length, time.n) - 1;
  if (!(row >= -0.5) || row > last + 0.5) return NaN;
  const at = clamp(Math.floor(row + 1e-6), 0, last);
  if (step || at === last) return values[at];
  const part = clamp(row - at, 0, 1);
  return part < 1e-6 ? values[at] : values[at] * (1 - part) + values[at + 1] * part;
}
