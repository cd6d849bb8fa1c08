// Axes: scales, ticks, number formats, and what all charts share.
import { css } from "./colours.js";

export const LEFT = 52;  // [px] for the numbers of the vertical axis

export function short(value, digits = 3) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace("e+", "e").replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(size >= 10 ** digits ? Math.ceil(Math.log10(size + 1)) : digits)));
}

export const spaced = count => String(Math.round(count)).replace(/\B(?=(\d{3})+(?!\d))/g, " ");

export function niceTicks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= raw * (1 - 1e-9));
  const ticks = [];
  for (let at = Math.ceil(low / step - 1e-9); at * step <= high * (1 + 1e-9) + 1e-300; ++at) ticks.push(Number((at * step).toPrecision(12)));
  return ticks;
}

// The y axis for these values: linear including 0, or logarithmic. place(value) is in [0, 1], 0 at the bottom.
export function verticalScale(values, logarithmic, signed = false) {
  const known = values.filter(v => v !== null && Number.isFinite(v));
  if (logarithmic) {
    const positive = known.filter(v => v > 0);
    const low = Math.floor(Math.log10(Math.min(...positive, 1e300)) + 1e-9), high = Math.max(low + 1, Math.ceil(Math.log10(Math.max(...positive, 1e-300)) - 1e-9));
    const stride = Math.ceil((high - low) / 7), ticks = [];
    for (let power = low; power <= high; ++power) if ((power - low) % stride === 0) ticks.push(10 ** power);
    return { logarithmic, low: 10 ** low, high: 10 ** high, ticks, place: v => v > 0 ? Math.max((Math.log10(v) - low) / (high - low), 0) : 0 };
  }
  const high = 1.06 * known.reduce((most, v) => Math.max(most, v), 0), low = signed ? 1.06 * known.reduce((least, v) => Math.min(least, v), 0) : 0;
  const top = high - low > 0 ? high : low + 1;
  return { logarithmic, low, high: top, ticks: niceTicks(low, top, 5), place: v => (v - low) / (top - low) };
}

// A linear y axis that spans these values, and at least `least` of their unit: it need not include 0.
export function rangeScale(values, least) {
  let from = Infinity, to = -Infinity;
  for (const v of values) if (v !== null && Number.isFinite(v)) [from, to] = [Math.min(from, v), Math.max(to, v)];
  if (from > to) from = to = 0;
  const half = 0.54 * Math.max(to - from, least), low = (from + to) / 2 - half, high = (from + to) / 2 + half;
  return { low, high, ticks: niceTicks(low, high, 5), place: v => (v - low) / (high - low) };
}

// Largest over smallest value: above 30 along the string (1000 over k) the axis is logarithmic, as in the figures of `plot`.
export function spread(values) {
  const positive = values.filter(v => v !== null && v > 0);
  return positive.length ? positive.reduce((a, b) => Math.max(a, b)) / positive.reduce((a, b) => Math.min(a, b)) : 1;
}

// First, last and round numbers between them.
export function followerTicks(n) {
  const room = 0.06 * n;
  return [...(n > 1 ? [1] : []), ...niceTicks(1, n, 6).filter(t => Number.isInteger(t) && t > 1 + room && t < n - room), n];
}

// A canvas context in CSS pixels, cleared.
export function canvasOf(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// A line through the points that exist.
export function line(context, xs, values, y) {
  let down = false;
  context.beginPath();
  values.forEach((v, at) => {
    if (v === null) return void (down = false);
    if (down) context.lineTo(xs[at], y(v)); else context.moveTo(xs[at], y(v));
    down = true;
  });
  context.stroke();
}

// Grid lines with their numbers, the axis at the foot, and the quantity at the top.
export function drawGrid(context, scale, y, foot, right, words) {
  context.lineWidth = 1;
  for (const t of scale.ticks) {
    context.strokeStyle = css("--grid");
    context.beginPath();
    context.moveTo(LEFT, y(t));
    context.lineTo(right, y(t));
    context.stroke();
    label(context, short(t), LEFT - 7, y(t) + 4, "right");
  }
  label(context, words, LEFT + 4, 11, "left");
  context.strokeStyle = css("--soft");
  context.strokeRect(LEFT, foot, right - LEFT, 0);
}

// Writes a text in a canvas, its baseline at y.
export function label(context, text, x, y, align, { colour = css("--soft"), font = "12px" } = {}) {
  context.fillStyle = colour;
  context.font = `${font} system-ui, 'DejaVu Sans', sans-serif`;
  context.textAlign = align;
  context.fillText(text, x, y);
}
