// One panel of the time line on its canvas, from the back to the front: spans, grid, curves, marks, labels.

const GUTTER = 46; // pixels for the numbers on the left, the same in all panels so that time lines up
const MARGIN = 10;
const LABEL_ROW = 13;
const FONT_PX = 11;
const LEAST_TICK_PX = 18;

/** Keeps labels apart: a place is given away once. */
class LabelSpace {
  constructor(left, top, right, bottom) {
    this.bounds = { left, top, right, bottom };
    this.taken = [];
    this.points = [];
  }

  /** Keeps labels off a curve, given as its points in pixels, in order across. */
  avoid(points) {
    this.points.push(...points);
  }

  fits(box) {
    const { left, top, right, bottom } = this.bounds;
    if (box.left < left || box.right > right || box.top < top || box.bottom > bottom) return false;
    const apart = (other) =>
      box.right + 3 <= other.left || other.right + 3 <= box.left || box.bottom <= other.top || other.bottom <= box.top;
    const onCurve = ([across, down]) =>
      across > box.left - 2 && across < box.right + 2 && down > box.top - 1 && down < box.bottom + 1;
    return this.taken.every(apart) && !this.points.some(onCurve);
  }

  /** Takes a spot away from all labels. */
  keep(across, down, radius) {
    this.taken.push({ left: across - radius, right: across + radius, top: down - radius, bottom: down + radius });
  }

  /** The first of the [left, top] places where a label of this size fits, or null. */
  claim(places, width, height) {
    for (const [left, top] of places) {
      const box = { left, top, right: left + width, bottom: top + height };
      if (!this.fits(box)) continue;
      this.taken.push(box);
      return box;
    }
    return null;
  }
}

/** Marks in rows of labels above the curves: each to the right of its line, or to the left where that is full. */
function markRows(context, marks, x, width) {
  const rows = [];
  const placed = [];
  for (const mark of [...marks].sort((one, other) => one.t - other.t)) {
    const across = x(mark.t);
    if (across < GUTTER - 1 || across > width - MARGIN + 1) continue;
    const wide = context.measureText(mark.label).width + 4;
    const beside = across + 3 + wide <= width - 2 ? across + 3 : across - 3 - wide;
    const left = Math.max(beside, 0); // a label wider than either side stands over its line
    let row = rows.findIndex((end) => left >= end + 6);
    if (row < 0) row = rows.push(-Infinity) - 1;
    rows[row] = Math.max(left + wide, across);
    placed.push({ mark, across, left, wide, row });
  }
  return { placed, count: rows.length };
}

/** Where things are in a panel of this size: {x, y, top, bottom, left, right, marks}. */
function layPanel(context, panel, view, range, width, height) {
  const left = GUTTER;
  const right = width - MARGIN;
  const x = linear(view.from, view.to, left, right);
  const marks = markRows(context, panel.marks, x, width);
  const top = 5 + marks.count * LABEL_ROW;
  const bottom = height - 6;
  return { x, y: linear(range.low, range.high, bottom, top), top, bottom, left, right, marks };
}

/** Draws the whole of a panel but its cursor and handles; returns the layout. */
function drawPanel(surface, frame, panel, view, range, palette) {
  const { context, width, height } = surface;
  context.font = `${FONT_PX}px ${palette.font}`;
  context.textBaseline = "middle";
  const lay = layPanel(context, panel, view, range, width, height);
  const labels = new LabelSpace(lay.left + 2, 0, lay.right, height);
  for (const { left, row, mark } of lay.marks.placed) {
    labels.claim([[left, row * LABEL_ROW]], context.measureText(mark.label).width + 4, LABEL_ROW);
  }
  for (const series of panel.series) labels.avoid(curvePoints(frame.arrays[series.buffer] ?? [], frame.time, lay));
  for (const handle of frame.handles) if (handle.panel === panel.key) labels.keep(lay.x(handle.t), lay.y(handle.y), 8);
  inPlot(context, lay, () => {
    for (const span of panel.spans) drawSpan(context, span, lay, palette);
  });
  drawGrid(context, lay, view, palette);
  inPlot(context, lay, () => {
    for (const level of panel.levels) drawLevel(context, level, lay, palette);
    for (const series of panel.pinned) drawPinned(context, series, frame, lay, palette);
    for (const series of panel.series) drawSeries(context, series, frame, lay, palette);
  });
  drawMarks(context, lay, palette);
  drawLabels(context, panel, lay, labels, palette);
  return lay;
}

/** Draws with everything cut off outside of the plot's own box. */
function inPlot(context, lay, draw) {
  context.save();
  context.beginPath();
  context.rect(lay.left, lay.top - 2, lay.right - lay.left, lay.bottom - lay.top + 4);
  context.clip();
  draw();
  context.restore();
}

function drawGrid(context, lay, view, palette) {
  const { x, y, left, right, top, bottom } = lay;
  const levels = ticksOf(y.from, y.to, (bottom - top) / LEAST_TICK_PX);
  const decimals = tickDecimals(levels.step);
  context.setLineDash([]);
  context.lineWidth = 1;
  context.textAlign = "right";
  for (const value of levels.at) {
    const down = Math.round(y(value)) + 0.5;
    const zero = Math.abs(value) < levels.step / 1e6 && y.from < -1e-9;
    ruler(context, left, down, right, down, zero ? palette.line : palette.grid);
    context.fillStyle = palette.soft;
    context.fillText(numberText(value, decimals), left - 7, down);
  }
  for (const t of ticksOf(view.from, view.to, timeTicks(right - left)).at) {
    const across = Math.round(x(t)) + 0.5;
    ruler(context, across, top, across, bottom, palette.grid);
  }
  ruler(context, left + 0.5, top, left + 0.5, bottom, palette.line);
}

function timeTicks(width) {
  return Math.max(2, Math.floor(width / 62));
}

function ruler(context, left, top, right, bottom, colour) {
  context.strokeStyle = colour;
  context.beginPath();
  context.moveTo(left, top);
  context.lineTo(right, bottom);
  context.stroke();
}

function drawSpan(context, span, lay, palette) {
  const left = lay.x(span.from);
  const width = Math.max(1.5, lay.x(span.to) - left);
  const height = lay.bottom - lay.top;
  context.globalAlpha = 0.1;
  context.fillStyle = palette.limit;
  context.fillRect(left, lay.top, width, height);
  context.globalAlpha = 0.45;
  hatch(context, left, lay.top, width, height, palette.limit);
  context.globalAlpha = 1;
}

function drawLevel(context, level, lay, palette) {
  context.lineWidth = 1.2;
  context.setLineDash([2, 2]);
  ruler(context, lay.left, lay.y(level.at), lay.right, lay.y(level.at), palette[level.role] ?? palette.limit);
}

function drawSeries(context, series, frame, lay, palette) {
  const values = frame.arrays[series.buffer];
  if (!values) return;
  context.strokeStyle = palette[series.role] ?? palette.ink;
  context.lineWidth = series.width;
  context.lineJoin = "round";
  context.setLineDash(series.dash ?? []);
  strokeSeries(context, values, frame.time, lay.x, lay.y, series.step);
}

/** A curve of what is pinned, pale and broad behind the present ones. */
function drawPinned(context, series, frame, lay, palette) {
  context.globalAlpha = 0.3;
  context.strokeStyle = palette[series.role] ?? palette.ink;
  context.lineWidth = 4;
  context.setLineDash([]);
  strokeSeries(context, frame.arrays[series.buffer], frame.pinned, lay.x, lay.y, series.step);
  context.globalAlpha = 1;
}

function drawMarks(context, lay, palette) {
  context.textAlign = "left";
  context.lineWidth = 1;
  context.setLineDash([1, 2]);
  for (const { mark, across, row } of lay.marks.placed) {
    const at = Math.round(across) + 0.5;
    ruler(context, at, row * LABEL_ROW + 2, at, lay.bottom, palette[mark.role] ?? palette.ink);
  }
  for (const { mark, across, left, wide, row } of lay.marks.placed) {
    backed(context, left, row * LABEL_ROW, wide, palette.paper); // lines of marks in rows above pass behind
    context.fillStyle = palette[mark.role] ?? palette.ink;
    context.fillText(mark.label, left + 2, row * LABEL_ROW + LABEL_ROW / 2);
    if (mark.y === null || mark.y === undefined) continue;
    context.beginPath();
    context.arc(across, lay.y(mark.y), 3.2, 0, 2 * Math.PI);
    context.fill();
  }
}

/** Names of levels and spans, each where there is room; one without room is left to the legend's tooltip. */
function drawLabels(context, panel, lay, space, palette) {
  const said = new Set(); // a name that several spans share is written once
  for (const span of panel.spans) {
    if (said.has(span.label)) continue;
    said.add(span.label);
    label(context, span.label, spanPlaces(context, span, lay), space, palette.limit, palette.paper);
  }
  for (const level of panel.levels) {
    const down = lay.y(level.at);
    label(context, level.label, sidePlaces(context, level.label, lay, [down - 14, down + 2]), space, palette.limit, palette.paper);
  }
}

/** A curve as points not further apart than a label is high; labels need not know more of it. */
function curvePoints(values, time, lay) {
  const points = [];
  const every = Math.max(1, Math.floor(4 / Math.max(lay.x.slope * time.dt, 1e-9)));
  let before = null;
  for (let row = 0; row < values.length; row += every) {
    if (!Number.isFinite(values[row])) {
      before = null;
      continue;
    }
    const [across, down] = [lay.x(time.t0 + row * time.dt), lay.y(values[row])];
    const steps = before === null ? 1 : Math.max(1, Math.ceil(Math.abs(down - before) / LABEL_ROW));
    for (let k = 1; k <= steps; k += 1) points.push([across, before === null ? down : before + ((down - before) * k) / steps]);
    before = down;
  }
  return points;
}

function spanPlaces(context, span, lay) {
  const wide = context.measureText(span.label).width + 6;
  const [from, to] = [Math.max(lay.left, lay.x(span.from)), Math.min(lay.right, lay.x(span.to))];
  const lefts = [to - from > wide ? (from + to - wide) / 2 : to + 3, from - 3 - wide, to + 3];
  return [lay.top + 1, lay.bottom - LABEL_ROW - 1].flatMap((top) => lefts.map((left) => [left, top]));
}

function sidePlaces(context, text, lay, downs) {
  const wide = context.measureText(text).width + 6;
  const [from, to] = [lay.left + 5, lay.right - wide - 2];
  const lefts = [1, 0.5, 0, 0.75, 0.25, 0.875, 0.625, 0.375, 0.125].map((part) => from + (to - from) * part);
  return downs.flatMap((top) => lefts.map((left) => [left, top]));
}

function label(context, text, places, space, colour, paper) {
  if (!text) return;
  const box = space.claim(places, context.measureText(text).width + 6, LABEL_ROW);
  if (!box) return;
  backed(context, box.left, box.top, box.right - box.left, paper);
  context.textAlign = "left";
  context.fillStyle = colour;
  context.fillText(text, box.left + 3, box.top + LABEL_ROW / 2 + 0.5);
}

/** A pale ground for a label, so that it can be read over lines. */
function backed(context, left, top, width, paper) {
  context.globalAlpha = 0.78;
  context.fillStyle = paper;
  context.fillRect(left, top + 1, width, LABEL_ROW - 2);
  context.globalAlpha = 1;
}
