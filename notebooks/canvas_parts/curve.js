// One curve on a canvas, thinned to what the pixels can show.

/** Strokes rows as a line; NaN leaves a gap. `x` and `y` map to pixels, `ratio` is device pixels per pixel. */
function strokeSeries(context, values, time, x, y, step, ratio) {
  const count = Math.min(values.length, time.n);
  const start = x(time.t0);
  const pace = x.slope * time.dt;
  const pen = penOf(context, values, start, pace, y, step);
  context.beginPath();
  if (count <= 2 * Math.abs(x.end - x.start) * ratio) everyRow(values, count, pen);
  else fewestRows(values, count, pen, (row) => Math.floor((start + pace * row) * ratio));
  context.stroke();
}

/** Draws row after row of a curve: `to(row)` goes there, `lift()` leaves a gap. */
function penOf(context, values, start, pace, y, step) {
  let before = NaN;
  return {
    to(row) {
      const across = start + pace * row;
      if (before !== before) context.moveTo(across, y(values[row]));
      else {
        if (step) context.lineTo(across, y(before));
        context.lineTo(across, y(values[row]));
      }
      before = values[row];
    },
    lift() {
      before = NaN;
    },
  };
}

function everyRow(values, count, pen) {
  for (let row = 0; row < count; row += 1) {
    if (values[row] !== values[row]) pen.lift();
    else pen.to(row);
  }
}

/** Of each column of device pixels the lowest and the highest row, in their order: no peak is lost. */
function fewestRows(values, count, pen, columnOf) {
  let column = NaN;
  let low = -1;
  let high = -1;
  const flush = () => {
    if (low < 0) return;
    pen.to(Math.min(low, high));
    if (low !== high) pen.to(Math.max(low, high));
    low = high = -1;
  };
  for (let row = 0; row < count; row += 1) {
    const value = values[row];
    if (value !== value) {
      flush();
      pen.lift();
      column = NaN;
      continue;
    }
    const at = columnOf(row);
    if (at !== column) {
      flush();
      column = at;
      low = high = row;
    } else {
      if (value < values[low]) low = row;
      if (value > values[high]) high = row;
    }
  }
  flush();
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
