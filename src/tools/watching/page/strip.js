// Tracking errors over time (to the right) and along the string (downwards), by colour.
import { css, errorColour } from "./colours.js";
import { canvasOf, followerTicks, label, LEFT } from "./scale.js";

const MOST = 240, TOP = 2, BOTTOM = 22;

export class Strip {
  constructor(canvas) {
    this.canvas = canvas;
    this.picture = document.createElement("canvas");
    this.columns = [];
  }

  replace(columns) {
    this.columns = columns ?? [];
  }

  take(snapshot) {
    if (!snapshot) return void (this.columns = []);
    const last = this.columns[this.columns.length - 1];
    if (snapshot.step < 0 || (last && last.step === snapshot.step && last.realization === snapshot.realization)) return;
    this.columns.push(snapshot);
    if (this.columns.length > MOST) this.columns.shift();
  }

  // The error [m] at the ends of the colour scale: three standard deviations of the string's limit; without a limit the largest
  // seen.
  rangeOf(limit) {
    if (limit) return { most: 3 * Math.sqrt(limit), logarithmic: false };
    let most = 0, least = 0;
    for (const { tracking_error } of this.columns) {
      for (const error of tracking_error) most = Math.max(most, Math.abs(error ?? 0));
      least = Math.max(least, Math.abs(tracking_error[0] ?? 0));
    }
    return { most: most || 1, logarithmic: most > 12 * least && least > 0, knee: least / 2 };
  }

  draw(n, limit, samplePeriod) {
    const { context, width, height } = canvasOf(this.canvas), { most, logarithmic, knee } = this.rangeOf(limit);
    const share = logarithmic ? e => Math.sign(e) * Math.log1p(Math.abs(e) / knee) / Math.log1p(most / knee) : e => e / most;
    this.picture.width = MOST;
    this.picture.height = n;
    const painter = this.picture.getContext("2d"), image = painter.createImageData(MOST, n), offset = MOST - this.columns.length;
    this.columns.forEach((column, at) => column.tracking_error.forEach((error, row) => {
      if (error !== null) image.data.set([...errorColour(share(error)), 255], 4 * (row * MOST + offset + at));
    }));
    painter.putImageData(image, 0, 0);
    const foot = height - BOTTOM, right = width - 8;
    context.imageSmoothingEnabled = false;
    context.fillStyle = css("--grid");
    context.fillRect(LEFT, TOP, right - LEFT, foot - TOP);
    context.drawImage(this.picture, LEFT, TOP, right - LEFT, foot - TOP);
    for (const i of followerTicks(n)) label(context, i, LEFT - 7, Math.max(TOP + (i - 0.5) / n * (foot - TOP) + 4, 11), "right");
    this.drawTime(context, foot, right, samplePeriod);
    return { most, logarithmic };
  }

  // Whether a column begins another realization, or repeats its own after a restart.
  isNew(at) {
    const [before, column] = this.columns.slice(at - 1, at + 1);
    return column.realization !== before.realization || column.step <= before.step;
  }

  // Draws the first and last step, and a line at the start of each realization and of each attempt.
  drawTime(context, foot, right, samplePeriod) {
    const { columns } = this, x = at => LEFT + (MOST - columns.length + at) / MOST * (right - LEFT);
    if (!columns.length) return;
    columns.forEach((column, at) => {
      if (at === 0 || !this.isNew(at)) return;
      const restart = column.realization === columns[at - 1].realization;
      context.fillStyle = css(restart ? "--alarm" : "--ink");
      context.fillRect(x(at) - (restart ? 1 : 0.5), TOP, restart ? 2 : 1, foot - TOP);
    });
    this.canvas.dataset.step = columns[columns.length - 1].step;
    this.canvas.dataset.restarts = columns.filter((column, at) => at && this.isNew(at) && column.realization === columns[at - 1].realization).length;
    const first = columns[0], last = columns[columns.length - 1];
    const end = `step ${last.step}`;
    label(context, end, right, foot + 16, "right");
    if (columns.length > 60) {
      const seconds = (last.step - first.step) * samplePeriod;
      const words = !columns.some((_, at) => at && this.isNew(at)) ? `step ${first.step}, ${seconds.toFixed(0)} s before` : `realization ${first.realization}, step ${first.step}`;
      if (x(0) + context.measureText(words).width + 12 < right - context.measureText(end).width) label(context, words, x(0), foot + 16, "left");
    }
  }
}
