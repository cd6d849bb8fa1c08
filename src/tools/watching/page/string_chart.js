// Variance along the string: a bar with standard errors per follower, theory on top, the limit as a line.
import { followerColour } from "./colours.js";
import { followerTicks, short, spread, verticalScale } from "./scale.js";

export const MOST_WHISKERS = 200;
const WIDE_RANGE = 30, LEFT = 52, RIGHT = 10, TOP = 22, BOTTOM = 38;

function element(tag, attributes = {}, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

export class StringChart {
  constructor(svg, choose) {
    this.svg = svg;
    this.layers = ["axes", "bars", "over"].map(name => svg.appendChild(element("g", { class: name })));
    svg.addEventListener("pointermove", event => choose(this.followerAt(event)));
    svg.addEventListener("pointerdown", event => choose(this.followerAt(event)));
  }

  followerAt(event) {
    const x = event.clientX - this.svg.getBoundingClientRect().left - LEFT;
    return this.slot ? Math.min(Math.max(Math.floor(x / this.slot) + 1, 1), this.followers) : null;
  }

  draw(of, chosen) {
    const [axes, bars, over] = this.layers, n = of.variance.length;
    const width = this.svg.clientWidth, height = this.svg.clientHeight, right = width - RIGHT, foot = height - BOTTOM;
    this.followers = n;
    this.slot = (right - LEFT) / n;
    const x = i => LEFT + (i - 0.5) * this.slot;
    const ends = of.variance.map((v, at) => v === null ? null : v + (n > MOST_WHISKERS ? 0 : 2 * (of.standard_error[at] ?? 0)));
    const limit = of.limit_variance === null ? [] : [of.limit_variance];
    const known = [...of.variance, ...of.theoretical_variance];
    const scale = verticalScale([...ends, ...of.theoretical_variance, ...limit], spread(known) > WIDE_RANGE);
    const y = v => foot - Math.min(Math.max(scale.place(v), 0), 1) * (foot - TOP);
    this.svg.dataset.logarithmic = scale.logarithmic;
    this.svg.dataset.high = scale.high;
    this.svg.dataset.low = scale.low;
    this.svg.dataset.foot = foot;
    this.svg.dataset.top = TOP;

    axes.replaceChildren(
      ...scale.ticks.flatMap(t => [element("path", { class: "grid", d: `M${LEFT} ${y(t)}H${right}` }),
        element("text", { x: LEFT - 7, y: y(t) + 4, "text-anchor": "end" }, short(t))]),
      element("path", { class: "axis", d: `M${LEFT} ${TOP}V${foot}H${right}` }),
      ...followerTicks(n).map(i => element("text", { x: x(i), y: foot + 17, "text-anchor": "middle" }, i)),
      element("text", { x: (LEFT + right) / 2, y: foot + 34, "text-anchor": "middle" }, "follower i"),
      element("text", { x: 0, y: 9 }, `m²${scale.logarithmic ? ", logarithmic" : ""}`));

    while (bars.childElementCount > n) bars.lastChild.remove();
    while (bars.childElementCount < n) bars.append(element("rect", { "data-follower": bars.childElementCount + 1 }));
    const bar = Math.max(this.slot * (n > 60 ? 1 : 0.72), 0.5);
    of.variance.forEach((v, at) => {
      const rect = bars.children[at], top = v === null ? foot : y(v);
      rect.setAttribute("x", x(at + 1) - bar / 2);
      rect.setAttribute("width", bar);
      // On a logarithmic axis the length of a bar has no meaning: draw a mark at the value.
      rect.setAttribute("y", scale.logarithmic ? top - 2.5 : top);
      rect.setAttribute("height", v === null ? 0 : scale.logarithmic ? 5 : Math.max(foot - top, 0));
      rect.setAttribute("fill", followerColour(at + 1, n));
      rect.setAttribute("class", at + 1 === chosen ? "chosen" : "");
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
