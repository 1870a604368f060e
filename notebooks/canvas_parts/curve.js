// Curves, hatches and bitmaps of a canvas.

/** Strokes rows as a line; NaN leaves a gap. `x` and `y` map to pixels. The kernel thins what has more rows than pixels. */
function strokeSeries(context, values, time, x, y, step) {
  const count = Math.min(values.length, time.n);
  const [start, pace] = [x(time.t0), x.slope * time.dt];
  let before = NaN;
  context.beginPath();
  for (let row = 0; row < count; row += 1) {
    const value = values[row];
    if (value === value) {
      const across = start + pace * row;
      if (before !== before) context.moveTo(across, y(value));
      else {
        if (step) context.lineTo(across, y(before));
        context.lineTo(across, y(value));
      }
    }
    before = value;
  }
  context.stroke();
}

/** Hatches a rectangle by slanting lines, which survive a grey printer. */
function hatch(context, left, top, width, height, colour) {
  context.save();
  context.beginPath();
  context.rect(left, top, width, height);
  context.clip();
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.setLineDash([]);
  context.beginPath();
  const first = Math.floor((left - height) / 7) * 7; // on one grid, so that neighbouring spans agree
  for (let across = first; across < left + width; across += 7) {
    context.moveTo(across, top + height);
    context.lineTo(across + height, top);
  }
  context.stroke();
  context.restore();
}

/** Makes the bitmap of a canvas fit a box of {width, height} sharply; returns its context in CSS pixels, or null without a box. */
function fitted(canvas, { width, height }) {
  if (!width || !height) return null;
  const ratio = window.devicePixelRatio || 1;
  const wide = Math.round(width * ratio);
  const high = Math.round(height * ratio);
  if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height, ratio };
}
