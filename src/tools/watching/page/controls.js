// The commands of the page. The server rejects commands from other origins, and reports why a command fails.

import { short } from "./scale.js";

const CHANGES = ["headway", "noise_variance", "loss"];
const HEADWAYS = { samples: { unit: "[T<sub>s</sub>]", min: 0.5, max: 6, step: 0.1 }, seconds: { unit: "[s]", min: 0.1, max: 4, step: 0.05 } };
const NOISES = { max: 2, step: 0.05 };  // [m^2]
const input = name => document.getElementById(name);

const bounds = ([low, high], digits) => `${short(low, digits)} to ${short(high, digits)}`;

// What each order does, in real units, within the limits of the leader.
function effects({ speed, acceleration, brake, accelerate, sinusoid, cruise }, fastestCar) {
  const [, fastest] = speed, isCar = fastest <= fastestCar, known = acceleration.every(value => value !== null);
  return {
    brake: `${short(brake.acceleration)} m/s² until it stands`,
    accelerate: `${short(accelerate.acceleration)} m/s², ${short(accelerate.speed)} m/s faster` + (isCar ? `, to ${short(fastest)} m/s at most` : ""),
    sinusoid: `± ${short(sinusoid.speed)} m/s in ${short(sinusoid.seconds)} s`,
    cruise: `back, by ${bounds(cruise.acceleration)} m/s²`,
    speed: (isCar ? `${bounds(speed)} m/s` : `cars reach ${short(fastestCar)} m/s`) + (known ? `, by ${bounds(acceleration)} m/s²` : ", at once"),
  };
}

export class Controls {
  constructor() {
    this.answer = document.getElementById("answer");
    this.set = {};    // the values of the sliders, in their units
    this.shown = {};  // those of the vehicles: one, the least and the greatest, or none
    for (const button of document.querySelectorAll("[data-command]")) button.addEventListener("click", () => this.send(button.dataset.command));
    for (const name of CHANGES) input(name).addEventListener("input", () => this.showChange(name));
    document.getElementById("controls").addEventListener("submit", event => event.preventDefault());
  }

  showChange(name) {
    // A slider that was not moved shows the value of the run, of unlike vehicles the least and the greatest, not the nearest one of its own.
    const slider = input(name), ends = slider.value === this.nearest(name) ? this.shown[name] : [Number(slider.value)];
    const words = (digits, scale) => new Set(ends).size > 1 ? bounds(ends.map(end => end * scale), digits) : ends.length ? short(ends[0] * scale, digits) : "–";
    const other = name !== "headway" || !this.period ? "" : this.inSeconds ? ` = ${words(3, 1 / this.period)} samples` : ` = ${words(3, this.period)} s`;
    document.querySelector(`output[for=${name}]`).textContent = words(4, 1) + other;
  }

  // Sets the sliders to the values of the run.
  take(configuration) {
    const endless = Boolean(configuration?.endless);
    document.getElementById("controls-card").hidden = !endless;
    this.period = configuration?.sample_period;
    this.inSeconds = Boolean(configuration?.headway_in_seconds);
    if (endless) this.showEffects(configuration);
    const { unit, ...range } = this.inSeconds ? HEADWAYS.seconds : HEADWAYS.samples;
    input("headway-unit").innerHTML = unit;
    Object.assign(input("headway"), range);
    this.marked = null;  // redraw the marks: the slider's range may change
    document.getElementById("controls-note").textContent = endless || !configuration ? "" :
      "Only an endless run (live.launch) accepts orders: this one averages over realizations, which have to be alike.";
    for (const name of CHANGES) {
      const unit = name === "headway" ? this.headwayUnit() : 1, changeable = configuration?.changeable?.[name], present = configuration?.[name] ?? [];
      input(name).closest("label").hidden = endless && changeable === undefined;  // no vehicle would change, as with constant spacing
      this.set[name] = (changeable ?? 0) * unit;
      this.shown[name] = [present].flat().map(value => value * unit);
      const slider = input(name), small = this.set[name] > 0 && this.set[name] < NOISES.max / 10;
      if (name === "noise_variance") Object.assign(slider, small ? { max: 4 * this.set[name], step: this.set[name] / 20 } : NOISES);
      if (this.set[name] > Number(slider.max)) slider.max = 2 * this.set[name];
      slider.value = this.set[name];
      this.showChange(name);
    }
  }

  showEffects({ manoeuvres, fastest_car }) {
    const words = effects(manoeuvres, fastest_car), [min, max] = manoeuvres.speed, speed = input("speed");
    for (const [command, text] of Object.entries(words)) document.querySelector(`[data-command=${command}] small`).textContent = text;
    Object.assign(speed, { min, max });
    if (!speed.checkValidity()) speed.value = max;
  }

  // One sample period in the slider's unit.
  headwayUnit() {
    return this.inSeconds ? this.period : 1;
  }

  // Marks the string stable headways below the slider, each interval with its lower end as a number.
  mark(given) {
    if (String(given) === this.marked) return;
    this.marked = String(given);
    const intervals = given.map(interval => interval.map(h => h * this.headwayUnit()));
    const slider = input("headway"), low = Number(slider.min), high = Number(slider.max);
    const share = h => 100 * Math.min(Math.max((h - low) / (high - low), 0), 1);
    document.getElementById("stable-headways").replaceChildren(...intervals.filter(([from, to]) => from < high && to > low).flatMap(([from, to]) => {
      const [stretch, word] = ["i", "b"].map(name => document.createElement(name));
      Object.assign(stretch.style, { left: `${share(from)}%`, right: `${100 - share(to)}%` });
      stretch.dataset.from = from;
      word.textContent = `stable from ${short(from)}`;
      word.style.left = `${share(from)}%`;
      return from > low ? [stretch, word] : [stretch];
    }));
  }

  content(command) {
    if (command === "speed") return { command, speed: input("speed").value === "" ? null : Number(input("speed").value) };
    if (command !== "change") return { command };
    // Only sliders that were moved: an untouched slider shows the nearest of its own values, not the run's.
    const changed = CHANGES.filter(name => Number(input(name).value) !== Number(this.nearest(name)));
    return { command, ...Object.fromEntries(changed.map(name => [name, Number(input(name).value) / (name === "headway" ? this.headwayUnit() : 1)])) };
  }

  nearest(name) {
    const slider = input(name).cloneNode();
    slider.value = this.set[name];
    return slider.value;
  }

  async send(command) {
    this.show(null, "…");
    try {
      const response = await fetch("command", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(this.content(command)) });
      const { success, message } = await response.json();
      this.show(success, message);
    } catch (error) {
      this.show(false, "the dashboard does not answer: " + error.message);
    }
  }

  show(success, message) {
    this.answer.dataset.success = success;
    this.answer.textContent = message;
  }
}
