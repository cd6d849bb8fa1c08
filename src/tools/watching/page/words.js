// The headline, the facts below it, and the numbers as text and as a table.
import { gapWords, place, worstOf } from "./gap_chart.js";
import { short, spaced } from "./scale.js";
import { MOST_WHISKERS } from "./string_chart.js";

const at = id => document.getElementById(id);
const write = (element, text) => { if (element.textContent !== text) element.textContent = text; };

const seconds = (steps, { sample_period }) => `${+(steps * sample_period).toPrecision(6)} s`;
const atStep = (step, run) => step == null ? "–" : `${seconds(step, run)} (step ${step})`;

// Text on the present content of the averages.
function averagesOf(of, run, health) {
  if (of.step === null && health?.start) return health.start;
  if (!of.time_average) return of.step === null ? `theory; the first figures appear when a batch of realizations is complete, behind ${atStep(run.steps - 1, run)}` : `at ${atStep(of.step, run)}, ${spaced(of.realizations)} realizations`;
  const until = of.paused_until, early = of.step === null && of.provisional;
  if (until === null) return of.step === null ? `theory; burn-in of ${seconds(run.burn_in, run)} (${run.burn_in} steps)` : `averages over time up to ${atStep(of.step, run)}`;
  const end = `until ${atStep(until, run)}, in ${seconds(until - of.latest_step, run)} of driving`;
  if (early) return of.manoeuvre ? `provisional averages, paused while the leader manoeuvres: burn-in at the earliest ${end}` :
    `provisional averages${early.step === null ? "" : ` up to ${atStep(early.step, run)}`}: burn-in ${end}`;
  if (of.step === null) return `theory; burn-in ${end}`;
  return of.manoeuvre ? `averages paused: the leader manoeuvres; at the earliest ${end}` : `averages paused: burn-in after a manoeuvre or restart, ${end}`;
}

export function showHeadline({ configuration, statistics, conduct, health }, live) {
  at("conduct").hidden = !conduct;
  write(at("conduct"), conduct ? `${conduct.possible ? "✓" : "✗"} The cars: ${conduct.words}` : "");
  at("conduct").dataset.possible = conduct?.possible ?? null;
  const stable = statistics?.string_stable ?? null;
  if (configuration) {
    const verdict = !statistics ? "Starting" : stable === null ? (statistics.theory === "exact" ? "Undecided" : "No theory") : stable ? "✓ String stable" : "✗ Not string stable";
    write(at("verdict"), verdict);
    write(at("reason"), statistics ? statistics.reason.replace(/^(not )?(string|mean square) stable: /, "") : health?.start ?? "The first figures appear when every vehicle runs.");
    at("warnings").replaceChildren(...(statistics?.warnings ?? []).map(warning => Object.assign(document.createElement("li"), { textContent: `⚠ ${warning}` })));
    document.title = `${verdict.replace(/^. /, "")}, ${configuration.spacing}`;
  }
  at("verdict").dataset.stable = stable;
  const complete = statistics?.complete;
  write(at("connection"), complete && live !== "paused" ? "complete" : live ?? "connection lost, trying again");
  at("connection").dataset.live = complete || live === "live";
  const culprit = complete ? null : health?.culprit;
  at("culprit").hidden = !culprit;
  write(at("culprit"), culprit ? `Run stalled: ${culprit} (${health.retries} retries)` : "");
  write(at("string-note"), statistics ? averagesOf(statistics, configuration, health) : "");
  at("string-note").dataset.paused = statistics?.step != null && statistics.paused_until !== null;
  const provisional = Boolean(statistics?.provisional);
  for (const id of ["string-key", "curves-key"]) at(id).hidden = !provisional;
  write(at("curves-note"), !statistics ? "" : !statistics.time_average ? "over realizations" : (provisional ? "provisional averages up to k" : "averages up to k") +
    (statistics.restarts ? ", since the latest restart" : ""));
  at("errors-key").hidden = !statistics?.standard_error.some(e => e !== null) || statistics.variance.length > MOST_WHISKERS;
  at("limit-key").hidden = statistics?.limit_variance == null;
  write(at("last-follower"), configuration ? String(configuration.followers) : "N");
}

const duration = seconds => seconds < 90 ? `${Math.ceil(seconds)} s` : seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;

export function facts(list, { configuration, statistics }, snapshot) {
  if (!configuration) return list.replaceChildren();
  const of = statistics ?? {}, shown = [["spacing", configuration.spacing], ["noise", configuration.noise], ["link", configuration.link], ["followers N", configuration.followers]];
  if (configuration.endless) shown.push(["time t", atStep(snapshot?.step ?? of.latest_step, configuration)]);
  else {
    shown.push(["realizations", `${spaced(of.realizations ?? 0)} of ${spaced(configuration.realizations_wanted)}`]);
    if (configuration.rate_wanted && !of.complete && snapshot) shown.push(["time t", `${seconds(snapshot.step, configuration)} of ${atStep(configuration.steps - 1, configuration)}`]);
  }
  if (!configuration.endless || of.max_abs_z != null) shown.push(["largest |z|", of.max_abs_z == null ? of.realizations_needed == null ? "–" : `no verdict before ${short(of.realizations_needed, 2)} realizations` : `${of.max_abs_z.toFixed(2)} (plausible to ${of.plausible_z.toFixed(2)})`]);
  if (of.vehicle_steps_per_second != null) shown.push(["vehicle-steps/s", short(of.vehicle_steps_per_second)]);
  if (of.seconds_left != null) shown.push(["time left", duration(of.seconds_left)]);
  if (of.complete) shown.push(["took", duration(of.wall_seconds)]);
  while (list.children.length > shown.length) list.lastChild.remove();
  while (list.children.length < shown.length) {
    const pair = list.appendChild(document.createElement("div"));
    pair.append(document.createElement("dt"), document.createElement("dd"));
  }
  shown.forEach(([name, value], place) => {
    write(list.children[place].children[0], name);
    write(list.children[place].children[1], String(value));
  });
}

export function readout({ statistics: of }, i, snapshot) {
  const early = of?.provisional;
  if (of?.step == null && !early) return "";
  if (!i) return "Point at a bar, or press → or ←, for the numbers of one follower.";
  const row = i - 1, error = snapshot?.tracking_error[row], z = of.score[row];
  const provisional = of.variance[row] == null && early, [mean, variance] = provisional ? [early.mean[row], early.variance[row]] : [of.mean[row], of.variance[row]];
  return `Follower ${i}: ${provisional ? "provisional " : ""}variance ${short(variance, 5)} m²` + (of.standard_error[row] == null ? "" : ` ± ${short(of.standard_error[row], 2)}`) +
    `, theory ${short(of.theoretical_variance[row], 5)}` + (z == null ? "" : `, z ${z.toFixed(2)}`) + `, mean ${short(mean)} m` +
    (error == null ? "" : `, now: error ${error > 0 ? "+" : ""}${error.toFixed(2)} m, ${snapshot.speed[i].toFixed(1)} m/s`);
}

// The worst gap in the title of its chart, and the chosen follower below it.
export function showGaps(of, i) {
  const worst = worstOf(of), row = Math.max(worst, 0);
  write(at("gaps-note"), worst < 0 ? "" : `${place(of, row)}, follower ${row + 1}`);
  write(at("gaps-readout"), worst < 0 ? "nothing is measured yet" : gapWords(of, i || row + 1));
}

// The latest event first.
export function showLog(list, events) {
  list.replaceChildren(...[...events].reverse().map(({ time, kind, step, text }) => {
    const item = document.createElement("li"), stamp = document.createElement("time");
    item.dataset.kind = kind;
    stamp.textContent = new Date(1000 * time).toLocaleTimeString("en-GB");
    item.append(stamp, step === null ? text : `step ${step}: ${text}`);
    return item;
  }));
}

export function showTable(body, of) {
  if (!of) return body.replaceChildren();
  const gaps = of.smallest_gap.length > 0, heading = [...body.parentElement.tHead.rows[0].cells];
  for (const cell of heading) if (cell.className === "gap") cell.hidden = !gaps;
  while (body.rows.length > of.variance.length) body.deleteRow(-1);
  while (body.rows.length < of.variance.length) {
    const row = body.insertRow();
    for (let c = 0; c < heading.length; ++c) row.insertCell();
  }
  const early = of.provisional;
  of.variance.forEach((variance, row) => {
    const cells = [row + 1, of.mean[row], variance, of.standard_error[row], of.theoretical_variance[row], of.score[row],
      ...gaps ? [of.smallest_gap[row], of.smallest_gap_realization[row], of.smallest_gap_step[row], of.collisions[row]] : [null, null, null, null]];
    cells.forEach((value, c) => {
      const cell = body.rows[row].cells[c];
      cell.dataset.value = value;
      cell.hidden = heading[c].hidden;
      const provisional = value == null ? [null, early?.mean[row], early?.variance[row]][c] ?? null : null;
      cell.className = provisional === null ? "" : "provisional";
      write(cell, provisional !== null ? `~ ${short(provisional, 6)}` : c === 0 || c > 6 ? String(value ?? "–") : c === 5 ? value?.toFixed(2) ?? "–" : short(value, 6));
    });
  });
}
