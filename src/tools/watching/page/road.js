// The road from above, in lanes from left to right: every vehicle at its position, and below it a mark at the position that its
// follower received. The view moves with the leader; long strings continue in the lane below.
import { css, followerColour, inkOn } from "./colours.js";
import { canvasOf, label, niceTicks, short } from "./scale.js";

const LEAST_GAP = 5.0;  // [m]
const LENGTH = 4.2;     // [m] length of a drawn vehicle, at most, if those of the model are points
const WIDTH = 1.6;
const FINGER = 24;      // [px]
const FOOT = 22;        // [px] below the lanes, for the scale

// A gap that four of five are below: behind a leader that stops, cars stand close ahead of others that still drive. Unstable motion
// at the tail does not affect the scale.
function usualGap(position) {
  const gaps = position.slice(1).map((p, i) => position[i] - p).sort((a, b) => a - b);
  return gaps[Math.floor(0.8 * gaps.length)];
}

export class Road {
  constructor(canvas) {
    this.canvas = canvas;
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
    this.reset();
  }

  // lengths: of the vehicles [m]; 0 for those that are points. heard: the vehicles that each follower hears; empty: its predecessor
  reset(lengths = this.lengths ?? [], heard = this.heard ?? []) {
    this.lengths = lengths;
    this.heard = heard;
    this.before = this.present = null;
    this.received = [];
    this.shown = [];  // the latest snapshots
    this.gap = null;
    this.interval = 100;
  }

  take(snapshot, now) {
    if (!snapshot) return this.reset();
    const same = this.present && snapshot.realization === this.present.realization;
    if (same && snapshot.step === this.present.step) return;
    this.follows = same && snapshot.step > this.present.step && snapshot.step - this.present.step <= 3;
    if (this.follows) this.interval += 0.2 * (Math.min(now - this.since, 1000) - this.interval);
    this.before = this.present;
    this.present = snapshot;
    this.shown = [...this.shown.slice(-7), snapshot];
    this.since = now;
  }

  // The received positions of a step may arrive before or after the true positions of that step.
  takeReceived(received) {
    if (received) this.received = [...this.received.slice(-7), received];
  }

  // Received minus true positions [m] at the latest step with both known, at most 5 steps ago; the marks move with the
  // vehicles in between. Both streams are thinned independently.
  offsets() {
    for (const snapshot of [...this.shown].reverse()) {
      const received = this.received.find(t => t.step === snapshot.step && t.realization === snapshot.realization);
      if (received && snapshot.realization === this.present.realization && this.present.step - snapshot.step <= 5)
        return received.position.map((p, i) => p - snapshot.position[i]);
    }
    return [];
  }

  // Positions interpolated between the two latest snapshots: smooth, with a lag of one interval.
  positions(now) {
    const to = this.present.position;
    if (!this.follows || this.still.matches) return to;
    const share = Math.min((now - this.since) / this.interval, 1), from = this.before.position;
    return to.map((p, i) => from[i] + share * (p - from[i]));
  }

  lanes(n, width) {
    const most = Math.max(Math.min(n + 1, Math.floor(width / (n > 200 ? 20 : n > 40 ? 26 : 42))), 5);
    const count = Math.ceil((n + 1) / most), across = Math.max(Math.ceil((n + 1) / count), 5);
    const lane = n < 9 ? 84 : count > 8 ? 26 : count > 3 ? 36 : 66;
    return { across, count, lane, speeds: lane > 60 && width / across > 30 };
  }

  layOut(n) {
    const { count, lane } = this.lanes(n, this.canvas.clientWidth);
    this.canvas.style.height = `${count * lane + FOOT}px`;
  }

  // [m]: drawn points do not touch the vehicle behind them, which is no collision.
  bodyLength(i, position) {
    if (this.lengths[i]) return this.lengths[i];
    const most = Math.min(LENGTH, 0.75 * (this.gap ?? LEAST_GAP)), behind = position[i] - position[i + 1];
    return behind > 0 ? Math.min(most, 0.9 * behind) : most;
  }

  // Speeds and overlaps in words.
  describe(note, length, key) {
    const of = this.present;
    key.hidden = this.canvas.dataset.speeds !== "true";
    const longest = Math.max(...this.lengths, 0), shortest = Math.min(...this.lengths, longest);
    length.textContent = longest === 0 ? "gap below 0, vehicles without length" :
      longest === shortest ? `gap below 0, length ${short(longest, 3)} m` : "gap below 0";
    note.textContent = "";
    if (!of?.speed.length) return;
    const [leader, ...others] = of.speed, over = of.colliding, fixed = v => v.toFixed(1);
    const slowest = others.reduce((least, v) => Math.min(least, v), Infinity), fastest = others.reduce((most, v) => Math.max(most, v), -Infinity);
    note.textContent = `leader ${fixed(leader)} m/s (${Math.round(3.6 * leader)} km/h), followers ${fixed(slowest)} to ${fixed(fastest)} m/s` +
      (over.length ? `; ${over.length} overlapping: ${over.slice(0, 8).join(", ")}${over.length > 8 ? ", …" : ""}` : "");
  }

  // The vehicle nearest to a click, within a finger's width in its lane; null without one.
  vehicleAt(event) {
    if (!this.present || !this.places) return null;
    const box = this.canvas.getBoundingClientRect(), x = event.clientX - box.left, row = Math.floor((event.clientY - box.top) / this.lane);
    let nearest = null, least = FINGER;
    this.places.forEach((place, i) => {
      if (place.row !== row || !(Math.abs(place.x - x) < least)) return;
      nearest = i;
      least = Math.abs(place.x - x);
    });
    return nearest;
  }

  draw(now, n, chosen, picks) {
    if (!this.present) return canvasOf(this.canvas);
    const { context, width, height } = canvasOf(this.canvas), { across, count, lane, speeds } = this.lanes(n, width);
    const position = this.positions(now);
    const wanted = Math.max(usualGap(position), LEAST_GAP);
    this.gap = this.gap === null ? wanted : this.gap + 0.05 * (wanted - this.gap);
    const metre = Math.min(width / (across + 1.2) / this.gap, lane * 0.34 / WIDTH);
    const longOf = i => Math.max(this.bodyLength(i, position) * metre, 4);
    const over = new Set(this.present.colliding);  // decided by the server, as its words are
    for (let row = 0; row < count; ++row) this.drawLane(context, row, lane, width, metre, position, across, n);
    const written = [];  // the place of the latest speed in each lane: standing vehicles are closer than their numbers are wide
    for (let i = 0; i <= n; ++i) {
      const row = Math.floor(i / across), x = this.x[row] + (position[i] - position[0]) * metre, middle = row * lane + lane * (speeds ? 0.24 : 0.36);
      const long = longOf(i), broad = Math.min(lane * (speeds ? 0.3 : 0.34), Math.max(0.6 * Math.min(long, LENGTH * metre), 4));
      if (x < -long || x > width + long) continue;
      this.drawVehicle(context, x, middle, long, broad, i, n, chosen === i ? 2.5 : picks.includes(i) ? 1.2 : 0);
      if (over.has(i)) this.drawOverlap(context, x, middle, long, broad, (position[i - 1] - position[i]) * metre, longOf(i - 1));
      if (!speeds || this.present.speed[i] === undefined || Math.abs(x - long / 2 - (written[row] ?? Infinity)) < 26) continue;
      written[row] = x - long / 2;
      label(context, this.present.speed[i].toFixed(1), written[row], row * lane + lane * 0.84, "center", { font: "11px" });
    }
    // Middle and length of each vehicle [px], for clicks.
    this.places = position.map((p, i) => {
      const row = Math.floor(i / across), long = longOf(i);
      return { row, x: this.x[row] + (p - position[0]) * metre - long / 2, y: (row + 0.4) * lane, long };
    });
    this.lane = lane;
    this.canvas.dataset.places = JSON.stringify(this.places.map(({ x, y, long }) => [x, y, long].map(Math.round)));
    this.drawHeard(context, chosen ?? n, n);
    this.drawReceived(context, position, lane, across, metre, n, speeds ? 0.5 : 0.62);
    this.drawScale(context, height, width, metre);
    Object.assign(this.canvas.dataset, { metre, overlaps: [...over].join(), speeds });
  }

  // An arc from each vehicle that a follower hears across others in its lane: of the chosen one, or the last.
  drawHeard(context, follower, n) {
    const own = this.places[follower], far = (this.heard[follower - 1] ?? []).filter(source => source < follower - 1 && this.places[source].row === own.row);
    context.strokeStyle = followerColour(follower, n);
    context.lineWidth = 1.5;
    for (const source of far) {
      const from = this.places[source].x, top = own.row * this.lane + 3;
      context.beginPath();
      context.moveTo(from, own.y - this.lane * 0.2);
      context.quadraticCurveTo((from + own.x) / 2, top - (own.y - top) * 0.2, own.x, own.y - this.lane * 0.2);
      context.stroke();
    }
    this.canvas.dataset.heard = far.join();
  }

  drawLane(context, row, lane, width, metre, position, across, n) {
    const first = row * across, last = Math.min(first + across - 1, n), top = row * lane + 1;
    // Each lane is centred on its own vehicles.
    let sum = 0;
    for (let i = first; i <= last; ++i) sum += position[i] - position[0] + (i - first) * this.gap;
    this.x ??= [];
    this.x[row] = width - 0.6 * this.gap * metre - sum / (last - first + 1) * metre;
    context.fillStyle = css("--road");
    context.fillRect(0, top, width, lane - 5);
    context.fillStyle = css("--marking");
    const period = 12 * metre, start = ((this.x[row] - position[0] * metre) % period + period) % period - period;
    for (let x = start; x < width && period > 6; x += period) context.fillRect(x, top + (lane - 5) - 2, period * 0.5, 2);
  }

  drawVehicle(context, x, middle, long, broad, i, n, frame) {
    context.fillStyle = i === 0 ? css("--soft") : followerColour(i, n);
    context.beginPath();
    context.roundRect(x - long, middle - broad / 2, long, broad, Math.min(broad / 3, 5));
    context.fill();
    if (long > 12) {
      context.fillStyle = css("--glass");
      context.fillRect(x - long * 0.36, middle - broad * 0.34, long * 0.13, broad * 0.68);
    }
    if (frame) {
      context.strokeStyle = css("--ink");
      context.lineWidth = frame;
      context.stroke();
    }
    if (broad > 15 && long > 20) {
      label(context, i === 0 ? "L" : i, x - long * 0.68, middle + 4, "center", { colour: i === 0 ? css("--card") : inkOn(i, n), font: "600 11px" });
    }
  }

  drawOverlap(context, x, middle, long, broad, ahead, longAhead) {
    context.fillStyle = context.strokeStyle = css("--alarm");
    context.globalAlpha = 0.55;
    const rear = Math.min(Math.max(x + ahead - longAhead, x - long), x);
    context.fillRect(rear, middle - broad / 2, Math.max(Math.min(x, x + ahead) - rear, 2), broad);
    context.globalAlpha = 1;
    context.lineWidth = 2;
    context.strokeRect(x - long, middle - broad / 2 - 2, long, broad + 4);
  }

  // A bar of a round number of metres, which holds for every lane.
  drawScale(context, height, width, metre) {
    const most = Math.min(220, 0.5 * width) / metre, metres = niceTicks(0, most, 3)[1], y = height - 7, long = metres * metre;
    context.strokeStyle = css("--ink");
    context.lineWidth = 1.5;
    context.beginPath();
    for (const at of [0, 0.5, 1]) {
      context.moveTo(1 + at * long, y - (at === 0.5 ? 3 : 5));
      context.lineTo(1 + at * long, y);
    }
    context.lineTo(1, y);
    context.stroke();
    label(context, `${short(metres)} m`, long + 8, y + 1, "left");
    this.canvas.dataset.scale = metres;
  }

  // A triangle in the follower's colour at the received position of its predecessor, with a line to the true position.
  drawReceived(context, position, lane, across, metre, n, share) {
    const offsets = this.offsets();
    const size = Math.max(lane * 0.11, 3);
    for (let i = 1; i <= offsets.length && i <= n; ++i) {
      const ahead = i - 1, row = Math.floor(ahead / across), y = row * lane + lane * share;
      const truth = this.x[row] + (position[ahead] - position[0]) * metre, x = truth + offsets[ahead] * metre;
      context.strokeStyle = context.fillStyle = followerColour(i, n);
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(truth, y);
      context.lineTo(x, y);
      context.stroke();
      context.beginPath();
      context.moveTo(x, y - size);
      context.lineTo(x - size * 0.8, y + size * 0.7);
      context.lineTo(x + size * 0.8, y + size * 0.7);
      context.fill();
    }
  }
}
