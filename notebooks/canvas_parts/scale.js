// From values to pixels: ranges, ticks, and the numbers beside them.

/** The step of nice ticks (1, 2 or 5 times a power of ten), so that about `count` of them fit into `span`. */
function niceStep(span, count) {
  const rough = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const head = rough / power;
  return (head <= 1 ? 1 : head <= 2 ? 2 : head <= 5 ? 5 : 10) * power;
}

function ticksOf(low, high, count) {
  if (!(high > low)) return { step: 1, at: [] };
  const step = niceStep(high - low, count);
  const at = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) at.push(k * step);
  return { step, at };
}

function tickDecimals(step) {
  return clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 6);
}

/** Decimals of a read-out, fixed for a panel so that the numbers do not jump about; at most what is known. */
function readoutDecimals(low, high, most = 4) {
  return clamp(2 - Math.floor(Math.log10(Math.max(high - low, 1e-6)) + 1e-9), 0, most);
}

/** Lowest and highest of everything that a panel shows, with some air; never an empty range. */
function rangeOf(panel, arrays, handles) {
  let low = Infinity;
  let high = -Infinity;
  const take = (value) => {
    if (value === null || !Number.isFinite(value)) return;
    if (value < low) low = value;
    if (value > high) high = value;
  };
  for (const series of [...panel.series, ...panel.pinned]) for (const value of arrays[series.buffer]) take(value);
  for (const level of panel.levels) take(level.at);
  for (const mark of panel.marks) take(mark.y);
  for (const handle of handles) if (handle.panel === panel.key) take(handle.y);
  if (low > high) return { low: 0, high: 1 };
  const middle = (low + high) / 2;
  const half = Math.max((high - low) / 2, Math.abs(middle) * 1e-3, 0.02);
  return { low: middle - half * 1.12, high: middle + half * 1.12 };
}

/** A straight map from [from, to] to pixels [start, end], with its way back. */
function linear(from, to, start, end) {
  const slope = (end - start) / (to - from || 1);
  const map = (value) => start + (value - from) * slope;
  map.back = (pixel) => from + (pixel - start) / slope;
  map.slope = slope;
  return Object.assign(map, { from, to, start, end });
}
