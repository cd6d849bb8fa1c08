// Smallest gap of each follower so far: a bar from 0, striking below 0, and the number of realizations with a collision above it.
import { followerColour } from "./colours.js";
import { element, FollowerChart, set } from "./follower_chart.js";
import { LEFT, short, spaced, verticalScale } from "./scale.js";

const ROOM = 7;  // pixels per digit

// The row of the smallest gap, the first of equal ones; -1 without one.
export function worstOf({ smallest_gap }) {
  return smallest_gap.reduce((worst, gap, row) => gap !== null && (worst < 0 || gap < smallest_gap[worst]) ? row : worst, -1);
}

export function place(of, row) {
  return `${short(of.smallest_gap[row])} m in realization ${of.smallest_gap_realization[row]} at step ${of.smallest_gap_step[row]}`;
}

// One follower's numbers as a sentence; "" before the first realization.
export function gapWords(of, i) {
  const row = i - 1, bound = of.collision_bound[row];
  if (of.smallest_gap[row] == null) return "";
  return `Follower ${i}: smallest gap ${place(of, row)}, a collision in ${spaced(of.collisions[row])} of ${spaced(of.realizations)} realizations` +
    (bound == null ? "" : `, by theory in at most ${short(100 * Math.min(bound, 1))} %`);
}

export class GapChart extends FollowerChart {
  draw(of, chosen) {
    const n = of.smallest_gap.length, scale = verticalScale(of.smallest_gap, false, true);
    const { bars, width, over, x, y, right } = this.layOut(n, scale, "m"), worst = worstOf(of);
    of.smallest_gap.forEach((gap, row) => {
      const rect = bars[row], top = gap === null ? y(0) : Math.min(y(gap), y(0));
      const height = gap === null ? 0 : Math.max(Math.abs(y(gap) - y(0)), 1);
      set(rect, { x: x(row + 1) - width / 2, y: top, width, height, fill: followerColour(row + 1, n),
        class: (gap < 0 ? "collision" : "") + (row + 1 === chosen ? " chosen" : "") });
      rect.dataset.value = gap;
      rect.replaceChildren(element("title", {}, gapWords(of, row + 1)));
    });
    const digits = Math.max(...of.collisions.map(count => String(count ?? "").length));
    this.roomy = this.slot >= ROOM * digits + 4;
    const counts = !this.roomy ? [] : of.collisions.map((count, row) => count ? element("text",
      { class: "count", x: x(row + 1), y: Math.min(y(0), y(of.smallest_gap[row] ?? 0)) - 6, "text-anchor": "middle" }, count) : null).filter(text => text);
    const circle = worst < 0 ? [] : [element("circle", { class: "worst", cx: x(worst + 1), cy: y(of.smallest_gap[worst]), r: 6 })];
    over.replaceChildren(element("path", { class: "zero", d: `M${LEFT} ${y(0)}H${right}` }), ...counts, ...circle);
  }
}
