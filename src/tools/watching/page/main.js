// Updates arrive as server-sent events. A figure is redrawn when its data change, the road in every frame.
import { setTheme, theme } from "./colours.js";
import { Controls } from "./controls.js";
import { drawCurves } from "./curves.js";
import { facts, readout, showHeadline, showTable } from "./words.js";
import { Road } from "./road.js";
import { short } from "./scale.js";
import { StringChart } from "./string_chart.js";
import { Strip } from "./strip.js";

const at = id => document.getElementById(id);
const known = { configuration: null, statistics: null, curves: null, health: null };
const stale = new Set();
let chosen = null, live = false;

const choose = follower => {
  if (follower === chosen) return;
  chosen = follower;
  for (const figure of ["string", "curves", "words"]) stale.add(figure);
};
const road = new Road(at("road")), strip = new Strip(at("strip")), controls = new Controls(), chart = new StringChart(at("string"), choose);
const everything = () => ["string", "curves", "strip", "words", "road"].forEach(figure => stale.add(figure));

const take = {
  configuration(news) {
    if (JSON.stringify(news) === JSON.stringify(known.configuration)) return;
    Object.assign(known, { configuration: news, statistics: null, curves: null });
    strip.replace([]);
    road.reset();
    chosen = null;
    controls.take(news);
    everything();
  },
  statistics(news) { known.statistics = news; controls.mark(news?.stable_headways ?? []); stale.add("string").add("words"); },
  curves(news) { known.curves = news; stale.add("curves"); },
  health(news) { known.health = news; stale.add("words"); },
  strip(news) { strip.replace(news); stale.add("strip"); },
  told(news) { road.hear(news); },
  snapshot(news) {
    road.take(news, performance.now());
    strip.take(news);
    stale.add("strip");
    if (chosen) stale.add("words");
  },
};

function connect() {
  const source = new EventSource("events");
  source.onopen = () => { live = true; stale.add("words"); };
  source.onerror = () => {
    live = false;
    stale.add("words");
    // Rejected (too many pages): the browser does not reconnect by itself.
    if (source.readyState === EventSource.CLOSED) setTimeout(connect, 3000);
  };
  for (const [kind, handler] of Object.entries(take)) source.addEventListener(kind, event => handler(JSON.parse(event.data)));
}

const draw = {
  string() { if (known.statistics) chart.draw(known.statistics, chosen); },
  curves() {
    if (!known.curves) return;
    const n = known.configuration.followers;
    drawCurves(at("mean"), known.curves, "mean", n, chosen, false);
    drawCurves(at("variance"), known.curves, "variance", n, chosen, true);
  },
  strip() {
    const { configuration, statistics } = known;
    if (!configuration) return;
    const { most, logarithmic } = strip.draw(configuration.followers, statistics?.limit_variance, configuration.sample_period);
    at("scale-low").textContent = `−${short(most)} m`;
    at("scale-high").textContent = `+${short(most)} m`;
    at("strip-note").textContent = "one realization: follower 1 on top, time to the right" + (logarithmic ? ", colours logarithmic" : "");
  },
  words() {
    showHeadline(known, live);
    facts(at("facts"), known);
    at("readout").textContent = readout(known, chosen, road.present);
    if (at("table-card").open) showTable(at("table").tBodies[0], known.statistics);
  },
  road() { if (known.configuration) road.layOut(known.configuration.followers); },
};

function frame(now) {
  requestAnimationFrame(frame);  // first: an error in this frame does not stop the next
  for (const figure of [...stale]) {
    stale.delete(figure);
    draw[figure]();
  }
  if (known.configuration && road.present) road.draw(now, known.configuration.followers, chosen);
}

function turnTheme() {
  setTheme(theme === "dark" ? "light" : "dark");
  everything();
}

const KEYS = {
  ArrowRight: () => known.configuration && choose(Math.min((chosen ?? 0) + 1, known.configuration.followers)),
  ArrowLeft: () => known.configuration && choose(Math.max((chosen ?? known.configuration.followers + 1) - 1, 1)),
  Escape: () => choose(null),
  t: () => { at("table-card").open = !at("table-card").open; },
  d: turnTheme,
  b: () => document.querySelector("[data-command=brake]").click(),
  a: () => document.querySelector("[data-command=accelerate]").click(),
  s: () => document.querySelector("[data-command=sinusoid]").click(),
  c: () => document.querySelector("[data-command=cruise]").click(),
  n: () => document.querySelector("[data-command=change]").click(),
};
addEventListener("keydown", event => {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (event.target.tagName === "INPUT" || event.ctrlKey || event.altKey || event.metaKey || !KEYS[key]) return;
  KEYS[key]();
  if (key.startsWith("Arrow")) event.preventDefault();
});

const darkWanted = matchMedia("(prefers-color-scheme: dark)");
darkWanted.addEventListener("change", () => { setTheme(darkWanted.matches ? "dark" : "light"); everything(); });
setTheme(darkWanted.matches ? "dark" : "light");
at("theme").addEventListener("click", turnTheme);
at("table-card").addEventListener("toggle", () => stale.add("words"));
new ResizeObserver(everything).observe(document.body);
controls.take(null);
connect();
requestAnimationFrame(frame);
