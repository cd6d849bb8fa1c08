// Gap, speed and acceleration over time of the vehicles that the reader picks, from the snapshots.
import { css, followerColour } from "./colours.js";
import { canvasOf, drawGrid, label, LEFT, line, niceTicks, rangeScale } from "./scale.js";

const MOST = 1200;      // snapshots: a minute at 20 a second
const MOST_PICKS = 6;
const MOST_COLOURS = 12;  // followers whose colours a reader can tell apart
const RIGHT = 10, TOP = 18, BOTTOM = 38;
export const QUANTITIES = [
  { name: "gap", unit: "m", least: 2 }, { name: "speed", unit: "m/s", least: 2 }, { name: "acceleration", unit: "m/s²", least: 1 }];

export class Motion {
  constructor(changed) {
    this.changed = changed;
    this.picks = [];
    this.begin(null);
    const number = document.getElementById("pick"), add = () => { if (number.checkValidity() && number.value !== "") this.toggle(Number(number.value)); };
    document.getElementById("pick-button").addEventListener("click", add);
    number.addEventListener("keydown", event => { if (event.key === "Enter") add(); });
  }

  // Another run: the picks stay if it has these vehicles.
  begin(configuration) {
    this.followers = configuration?.followers ?? 0;
    this.lengths = configuration?.vehicle_lengths ?? [];
    this.period = configuration?.sample_period ?? 1;
    this.paced = Boolean(configuration?.endless || configuration?.rate_wanted);  // else each realization is over in milliseconds
    this.columns = [];
    this.picks = this.picks.filter(i => i <= this.followers);
    if (configuration && !this.picks.length) this.picks = [...new Set([0, 1, this.followers])];
    document.getElementById("pick").max = this.followers;
  }

  toggle(i) {
    this.picks = this.picks.includes(i) ? this.picks.filter(other => other !== i) : [...this.picks.slice(1 - MOST_PICKS), i];
    this.changed();
  }

  take(snapshot) {
    if (!snapshot) return void (this.columns = []);
    const before = this.columns[this.columns.length - 1], steps = before ? snapshot.step - before.step : 0;
    if (snapshot.step < 0 || !snapshot.speed.length) return;
    if (before && before.realization === snapshot.realization && steps === 0) return;
    if (before && (before.realization !== snapshot.realization || steps < 0)) this.columns = [];  // another realization, or a restart
    const { realization, step, position, speed, acceleration } = snapshot;
    // After a pause of the page the lines begin again.
    const broken = this.columns.length > 0 && steps > Math.max(5, 4 * (before.steps || steps));
    this.columns.push({ realization, step, position, speed, acceleration, steps, broken });
    if (this.columns.length > MOST) this.columns.shift();
  }

  // A quantity of vehicle i in a column; null if there is none.
  value(name, i, { position, speed, acceleration }) {
    if (name === "gap") return i ? position[i - 1] - position[i] - this.lengths[i - 1] : null;
    if (name === "speed") return speed[i];
    return acceleration[i] ?? null;
  }

  // Draws the charts, and a button for each picked vehicle with its present values.
  draw(chosen) {
    document.getElementById("motion-card").hidden = !this.paced;
    if (!this.paced) return;
    for (const of of QUANTITIES) this.drawChart(document.getElementById(`motion-${of.name}`), of, chosen);
    this.showPicks(document.getElementById("picks"));
    const last = this.columns[this.columns.length - 1], seconds = last ? (last.step - this.columns[0].step) * this.period : 0;
    document.getElementById("motion-note").textContent = last ? `the latest ${seconds.toFixed(0)} s of vehicles ${this.picks.map(nameOf).join(", ") || "that you pick"}` : "nothing is measured yet";
  }

  drawChart(canvas, { name, unit, least }, chosen) {
    const { context, width, height } = canvasOf(canvas), foot = height - BOTTOM, right = width - RIGHT;
    const lines = this.picks.map(i => this.columns.map(column => this.value(name, i, column)));
    const scale = rangeScale(lines.flat(), least), y = v => foot - scale.place(v) * (foot - TOP);
    const times = this.columns.map(({ step }) => step * this.period), from = times[0] ?? 0, to = Math.max(times[times.length - 1] ?? 1, from + 1);
    const place = t => LEFT + (t - from) / (to - from) * (right - LEFT), xs = times.map(place);
    drawGrid(context, scale, y, foot, right, `${name}, ${unit}`);
    for (const t of niceTicks(from, to, Math.max(Math.floor(width / 65), 3)))
      label(context, `${t}`, Math.min(place(t), width - context.measureText(t).width / 2), foot + 16, "center");
    label(context, "time, s", (LEFT + right) / 2, foot + 32, "center");
    if (scale.low < 0 && scale.high > 0) {  // a gap below 0 is a collision
      context.strokeStyle = css(name === "gap" ? "--alarm" : "--soft");
      context.strokeRect(LEFT, y(0), right - LEFT, 0);
    }
    context.lineJoin = "round";
    this.picks.forEach((i, row) => {
      context.strokeStyle = this.colour(i);
      context.lineWidth = chosen === i ? 3 : 1.8;
      for (const [first, end] of this.stretches()) line(context, xs.slice(first, end), lines[row].slice(first, end), y);
    });
    const note = this.columns.length > 1 && lines.length && lines.flat().every(v => v === null) ? "the snapshots are too many steps apart" : "";
    label(context, note, (LEFT + right) / 2, (TOP + foot) / 2 - 8, "center");
    Object.assign(canvas.dataset, { low: scale.low, high: scale.high, from, to, note });
  }

  // [first, end) of the columns between two breaks.
  stretches() {
    const starts = [0, ...this.columns.flatMap(({ broken }, at) => broken && at ? [at] : [])];
    return starts.map((start, at) => [start, starts[at + 1] ?? this.columns.length]);
  }

  // Neighbours of a long string have nearly the same colour on the road: here the picks share the whole ramp.
  colour(i) {
    if (!i) return css("--soft");
    const picked = this.picks.filter(pick => pick).sort((a, b) => a - b);
    return this.followers <= MOST_COLOURS ? followerColour(i, this.followers) : followerColour(picked.indexOf(i) + 1, picked.length);
  }

  showPicks(box) {
    const last = this.columns[this.columns.length - 1];
    while (box.children.length > this.picks.length) box.lastChild.remove();
    while (box.children.length < this.picks.length) {
      const button = box.appendChild(document.createElement("button")), key = document.createElement("i");
      Object.assign(button, { type: "button", title: "leave this vehicle out" });
      key.className = "key line";
      button.append(key, "");
      button.addEventListener("click", () => this.toggle(Number(button.dataset.vehicle)));
    }
    this.picks.forEach((i, at) => {
      const button = box.children[at], words = last ? QUANTITIES.map(({ name, unit }) => {
        const value = this.value(name, i, last);
        return value === null ? null : `${value.toFixed(name === "gap" ? 1 : 2).replace(/^-(0\.0+)$/, "$1")} ${unit}`;
      }).filter(text => text).join(", ") : "";
      button.dataset.vehicle = i;
      button.firstChild.style.borderColor = this.colour(i);
      button.lastChild.textContent = `${nameOf(i)}${words && ": "}${words} \u00d7`;
    });
  }
}

const nameOf = i => i ? String(i) : "leader";
