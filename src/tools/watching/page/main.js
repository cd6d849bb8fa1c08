// Updates arrive as server-sent events. A figure is redrawn when its data change, the road in every frame.
import { setTheme, theme } from "./colours.js";
import { Controls } from "./controls.js";
import { drawCurves } from "./curves.js";
import { GapChart } from "./gap_chart.js";
import { facts, readout, showGaps, showHeadline, showLog, showTable } from "./words.js";
import { Motion } from "./motion.js";
import { Road } from "./road.js";
import { offerSaving } from "./save.js";
import { short } from "./scale.js";
import { Series } from "./series.js";
import { StringChart } from "./string_chart.js";
import { Strip } from "./strip.js";
import { TABLES } from "./tables.js";

const at = id => document.getElementById(id);
const known = { configuration: null, statistics: null, curves: null, conduct: null, health: null, log: [] };
const stale = new Set();
let chosen = null, live = "connecting", source = null;

const choose = follower => {
  if (follower === chosen) return;
  chosen = follower;
  for (const figure of ["string", "gaps", "curves", "motion", "facts"]) stale.add(figure);
};
const series = new Series(card => stale.add(card));
const road = new Road(at("road")), strip = new Strip(at("strip")), controls = new Controls(), chart = new StringChart(at("string"), choose);
const gapChart = new GapChart(at("gaps"), choose);
const motion = new Motion(() => stale.add("motion"));
const everything = () => ["string", "gaps", "curves", "strip", "motion", "words", "facts", "road"].forEach(figure => stale.add(figure));

const take = {
  configuration(news) {
    if (JSON.stringify(news) === JSON.stringify(known.configuration)) return;
    Object.assign(known, { configuration: news, statistics: null, curves: null, conduct: null });
    strip.replace([]);
    road.reset(news?.vehicle_lengths, news?.heard);
    motion.begin(news);
    chosen = null;
    controls.take(news);
    everything();
  },
  statistics(news) { known.statistics = news; controls.mark(news?.stable_headways ?? []); stale.add("string").add("gaps").add("words").add("facts"); },
  curves(news) { known.curves = news; stale.add("curves"); },
  health(news) { known.health = news; stale.add("words"); },
  log(news) { known.log = news; stale.add("log"); },
  strip(news) { strip.replace(news); stale.add("strip"); },
  conduct(news) { known.conduct = news; stale.add("words"); },
  received(news) { road.takeReceived(news); },
  snapshot(news) {
    road.take(news, performance.now());
    strip.take(news);
    motion.take(news);
    stale.add("strip").add("motion").add("facts");
  },
};

function connect() {
  const own = source = new EventSource("events");
  source.onopen = () => { live = "live"; stale.add("words"); };
  source.onerror = () => {
    live = null;
    stale.add("words");
    // Rejected (too many pages): the browser does not reconnect by itself.
    if (own.readyState === EventSource.CLOSED) setTimeout(() => source === own && connect(), 3000);
  };
  for (const [kind, handler] of Object.entries(take)) own.addEventListener(kind, event => handler(JSON.parse(event.data)));
}

// A paused page has no stream. The server keeps the strip, the curves and the log, and sends all of them on resumption.
function togglePause() {
  if (source) {
    source.close();
    source = null;
    live = "paused";
  } else {
    live = "connecting";
    connect();
  }
  at("pause").textContent = source ? "Pause" : "Continue";
  stale.add("words");
}

const about = () => {
  const { configuration: of, statistics } = known;
  return of ? `${of.spacing}, ${of.noise}, ${of.link}, N = ${of.followers}, ` +
    (of.endless ? `step ${road.present?.step ?? "–"}` : `${statistics?.realizations ?? 0} realizations`) : "";
};

const draw = {
  string() { if (known.statistics) chart.draw(series.shown("string", known.statistics), chosen); },
  gaps() {
    const of = known.statistics;
    at("gaps-card").hidden = !of?.smallest_gap.length;
    if (at("gaps-card").hidden) return;
    showGaps(of, chosen);
    gapChart.draw(series.shown("gaps", of), chosen);
    at("counts-key").hidden = !gapChart.roomy;
  },
  curves() {
    if (!known.curves) return;
    const n = known.configuration.followers, of = series.shown("curves", known.curves, chosen);
    drawCurves(at("mean"), of, "mean", n, chosen, false);
    drawCurves(at("variance"), of, "variance", n, chosen, true);
  },
  strip() {
    const { configuration, statistics } = known;
    if (!configuration) return;
    const { most, logarithmic } = strip.draw(configuration.followers, statistics?.limit_variance, configuration.sample_period);
    at("scale-low").textContent = `−${short(most)} m`;
    at("scale-high").textContent = `+${short(most)} m`;
    at("strip-note").textContent = "one realization: follower 1 on top, time to the right" + (logarithmic ? ", colours logarithmic" : "");
  },
  motion() { motion.draw(chosen); },
  words() {
    showHeadline(known, live);
    if (at("table-card").open) showTable(at("table").tBodies[0], known.statistics);
  },
  facts() {
    facts(at("facts"), known, road.present);
    at("readout").textContent = readout(known, chosen, road.present);
    road.describe(at("road-note"), at("body-length"), at("speed-key"));
  },
  log() {
    showLog(at("log"), known.log);
    at("log-note").textContent = known.log.length ? "the latest first" : "none yet";
  },
  road() { if (known.configuration) road.layOut(known.configuration.followers); },
};

function frame(now) {
  requestAnimationFrame(frame);  // first: an error in this frame does not stop the next
  if (stale.size) document.body.dataset.waiting = !known.statistics;  // charts need the size of their cards
  for (const figure of [...stale]) {
    stale.delete(figure);
    draw[figure]();
  }
  if (known.configuration && road.present) road.draw(now, known.configuration.followers, chosen, motion.paced ? motion.picks : []);
}

function turnTheme() {
  setTheme(theme === "dark" ? "light" : "dark");
  everything();
}

const KEYS = {
  ArrowRight: () => known.configuration && choose(Math.min((chosen ?? 0) + 1, known.configuration.followers)),
  ArrowLeft: () => known.configuration && choose(Math.max((chosen ?? known.configuration.followers + 1) - 1, 1)),
  Escape: () => choose(null),
  p: togglePause,
  t: () => { at("table-card").open = !at("table-card").open; },
  d: turnTheme,
  b: () => controls.send("brake"),
  a: () => controls.send("accelerate"),
  s: () => controls.send("sinusoid"),
  c: () => controls.send("cruise"),
  n: () => controls.send("change"),
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
at("pause").addEventListener("click", togglePause);
at("table-card").addEventListener("toggle", () => stale.add("words"));
new ResizeObserver(everything).observe(document.body);
controls.take(null);
at("road").addEventListener("click", event => {
  const vehicle = road.vehicleAt(event);
  if (vehicle !== null) motion.toggle(vehicle);
});
offerSaving(name => TABLES[name](known, road, strip, motion), about);
connect();
requestAnimationFrame(frame);
