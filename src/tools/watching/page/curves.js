// Mean and variance over k: measured curves broad and coloured, theory thin on top, as in the paper's figure. Provisional curves are pale
// and dashed.
import { css, followerColour } from "./colours.js";
import { canvasOf, drawGrid, label, LEFT, line, niceTicks, spread, verticalScale } from "./scale.js";

const WIDE_RANGE = 1000, RIGHT = 8;

// Draws one chart; `last`: with the axis of k below it.
export function drawCurves(canvas, of, name, n, chosen, last) {
  const { context, width, height } = canvasOf(canvas);
  const measured = of[name], theory = of["theoretical_" + name], top = 16, foot = height - (last ? 38 : 10), right = width - RIGHT;
  const peaks = rows => rows.map(row => row.reduce((most, v) => v === null ? most : Math.max(most, Math.abs(v)), 0));
  const logarithmic = name === "variance" && spread([...peaks(measured), ...peaks(theory)]) > WIDE_RANGE;
  const first = logarithmic ? [...measured, ...theory].flat().filter(v => v !== null && v > 0) : [...measured, ...theory].flat();
  const scale = verticalScale(first, logarithmic, name === "mean");
  const y = v => foot - Math.min(Math.max(scale.place(v), 0), 1) * (foot - top);
  const from = of.step[0] ?? 0, to = Math.max(of.step[of.step.length - 1] ?? 1, from + 1);
  const place = k => LEFT + (k - from) / (to - from) * (right - LEFT), xs = of.step.map(place);

  drawGrid(context, scale, y, foot, right, (name === "mean" ? "mean, m" : `variance, m²${logarithmic ? ", logarithmic" : ""}`) + (of.provisional ? ", provisional" : ""));
  if (last) {
    for (const k of niceTicks(from, to, 5).filter(Number.isInteger))
      label(context, k, Math.min(place(k), width - context.measureText(k).width / 2), foot + 16, "center");
    label(context, "step k", (LEFT + right) / 2, foot + 32, "center");
  }
  context.lineJoin = "round";
  of.followers.forEach((i, row) => {
    context.strokeStyle = followerColour(i, n);
    context.globalAlpha = (chosen && chosen !== i ? 0.25 : 0.8) * (of.provisional ? 0.5 : 1);
    context.setLineDash(of.provisional ? [5, 4] : []);
    context.lineWidth = chosen === i ? 3.4 : 2.2;
    line(context, xs, measured[row], y);
  });
  context.setLineDash([]);
  context.strokeStyle = css("--ink");
  of.followers.forEach((i, row) => {
    context.globalAlpha = chosen && chosen !== i ? 0.1 : 0.85;
    context.lineWidth = 0.7;
    line(context, xs, theory[row], y);
  });
  context.globalAlpha = 1;
}
