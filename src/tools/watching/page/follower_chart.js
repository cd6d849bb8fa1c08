// A chart along the string: a slot per follower; the pointer chooses one of them.
import { followerTicks, LEFT, short } from "./scale.js";

const TOP = 22, RIGHT = 10, BOTTOM = 38;

export function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
}

export function element(tag, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  set(made, attributes);
  if (text !== undefined) made.textContent = text;
  return made;
}

export class FollowerChart {
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

  // Draws the axes for n followers, and a rectangle for each. Returns them with the functions from follower and value to pixels.
  layOut(n, scale, unit) {
    const [axes, bars, over] = this.layers, right = this.svg.clientWidth - RIGHT, foot = this.svg.clientHeight - BOTTOM;
    this.followers = n;
    this.slot = (right - LEFT) / n;
    const x = i => LEFT + (i - 0.5) * this.slot;
    const y = v => foot - Math.min(Math.max(scale.place(v), 0), 1) * (foot - TOP);
    Object.assign(this.svg.dataset, { logarithmic: scale.logarithmic, high: scale.high, low: scale.low, foot, top: TOP });
    axes.replaceChildren(
      ...scale.ticks.flatMap(t => [element("path", { class: "grid", d: `M${LEFT} ${y(t)}H${right}` }),
        element("text", { x: LEFT - 7, y: y(t) + 4, "text-anchor": "end" }, short(t))]),
      element("path", { class: "axis", d: `M${LEFT} ${TOP}V${foot}H${right}` }),
      ...followerTicks(n).map(i => element("text", { x: x(i), y: foot + 17, "text-anchor": "middle" }, i)),
      element("text", { x: (LEFT + right) / 2, y: foot + 34, "text-anchor": "middle" }, "follower i"),
      element("text", { x: 0, y: 9 }, `${unit}${scale.logarithmic ? ", logarithmic" : ""}`));
    while (bars.childElementCount > n) bars.lastChild.remove();
    while (bars.childElementCount < n) bars.append(element("rect", { "data-follower": bars.childElementCount + 1 }));
    return { bars: [...bars.children], width: Math.max(this.slot * (n > 60 ? 1 : 0.72), 0.5), over, x, y, foot, right };
  }
}
