// Variance along the string: a bar with standard errors per follower, theory on top, the limit as a line. Provisional bars are pale.
import { followerColour } from "./colours.js";
import { element, FollowerChart, set } from "./follower_chart.js";
import { LEFT, short, spread, verticalScale } from "./scale.js";

export const MOST_WHISKERS = 200;
const WIDE_RANGE = 30;

export class StringChart extends FollowerChart {
  draw(of, chosen) {
    const n = of.variance.length, bar = of.variance.map((v, at) => v ?? of.provisional?.variance[at] ?? null);
    const ends = bar.map((v, at) => v === null ? null : v + (n > MOST_WHISKERS ? 0 : 2 * (of.standard_error[at] ?? 0)));
    const limit = of.limit_variance === null ? [] : [of.limit_variance];
    const known = [...bar, ...of.theoretical_variance];
    const scale = verticalScale([...ends, ...of.theoretical_variance, ...limit], spread(known) > WIDE_RANGE);
    const { bars, width, over, x, y, foot, right } = this.layOut(n, scale, "m²");
    bar.forEach((v, at) => {
      const rect = bars[at], top = v === null ? foot : y(v);
      // On a logarithmic axis the length of a bar has no meaning: draw a mark at the value.
      const [upper, height] = scale.logarithmic ? [top - 2.5, 5] : [top, Math.max(foot - top, 0)];
      set(rect, { x: x(at + 1) - width / 2, y: upper, width, height: v === null ? 0 : height, fill: followerColour(at + 1, n), class: (v !== null && of.variance[at] === null ? "provisional" : "") + (at + 1 === chosen ? " chosen" : "") });
      rect.dataset.value = v;
    });

    const cap = Math.min(this.slot / 5, 5);
    const whiskers = of.variance.map((v, at) => {
      const e = of.standard_error[at];
      if (v === null || e === null || e === undefined || n > MOST_WHISKERS) return "";
      const high = y(v + 2 * e), low = y(v - 2 * e), at_x = x(at + 1);
      // An interval that begins below the axis ends there, without a cap.
      const foot_cap = v - 2 * e >= scale.low ? `M${at_x - cap} ${low}h${2 * cap}` : "";
      return `M${at_x} ${high}V${low}M${at_x - cap} ${high}h${2 * cap}${foot_cap}`;
    }).join("");
    const theory = of.theoretical_variance.map((v, at) => v === null ? null : [x(at + 1), y(v)]).filter(p => p);
    const dots = n <= 60 ? theory.map(([px, py]) => element("circle", { class: "dots", cx: px, cy: py, r: 2.4 })) : [];
    const curve = theory.map(([px, py], at) => `${at ? "L" : "M"}${px} ${py}`).join("");
    over.replaceChildren(
      element("path", { class: "whiskers halo", d: whiskers }), element("path", { class: "whiskers", d: whiskers }),
      element("path", { class: "theory halo", d: curve }), element("path", { class: "theory", d: curve }), ...dots,
      ...limit.flatMap(v => [element("path", { class: "limit", d: `M${LEFT} ${y(v)}H${right}`, "data-value": v }),
        element("text", { class: "limit-word", x: LEFT + 8, y: y(v) - 6 }, `limit ${short(v, 4)} m²`)]));
  }
}
