// Followers: the paper's colours from dark blue (first) to dark red (last), as in the figures of `plot`; lighter on a dark page.
// Errors: blue to orange, which colour-blind readers can distinguish.

const LIGHT = ["#08205c", "#1f5fb4", "#3ba3c8", "#7fb77e", "#e3b23c", "#e0702b", "#c0261f", "#5c0410"];
const DARK = ["#5c86f5", "#3f9bf0", "#4fc3e0", "#8fd08f", "#f0c850", "#f28c48", "#f0605a", "#d8405f"];
const ERROR_LIGHT = ["#0b3c6f", "#2a7ab8", "#86bcdc", "#f7f7f5", "#f7b97a", "#d9711c", "#7a3203"];
const ERROR_DARK = ["#b5dcf7", "#5aaee6", "#25608f", "#14171c", "#8a4a12", "#ee8a35", "#ffd3a3"];

const numbersOf = list => list.map(c => [1, 3, 5].map(at => parseInt(c.slice(at, at + 2), 16)));
const RAMPS = { follower: { light: numbersOf(LIGHT), dark: numbersOf(DARK) }, error: { light: numbersOf(ERROR_LIGHT), dark: numbersOf(ERROR_DARK) } };

export let theme = "light";

export function setTheme(name) {
  theme = name;
  document.documentElement.dataset.theme = name;
  for (const [selector, list] of [[".ramp", name === "dark" ? DARK : LIGHT], [".diverging", name === "dark" ? ERROR_DARK : ERROR_LIGHT]])
    for (const element of document.querySelectorAll(selector)) element.style.background = `linear-gradient(90deg, ${list.join()})`;
}

export const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function along(ramp, share) {
  const at = Math.min(Math.max(share, 0), 1) * (ramp.length - 1), low = Math.min(Math.floor(at), ramp.length - 2), part = at - low;
  return ramp[low].map((value, c) => Math.round(value + part * (ramp[low + 1][c] - value)));
}

// The colour of follower i = 1 .. n.
export function followerColour(i, n) {
  return `rgb(${along(RAMPS.follower[theme], n > 1 ? (i - 1) / (n - 1) : 0).join()})`;
}

// The colour of text on follower i's colour: black or white.
export function inkOn(i, n) {
  const [r, g, b] = along(RAMPS.follower[theme], n > 1 ? (i - 1) / (n - 1) : 0);
  return 0.3 * r + 0.59 * g + 0.11 * b > 140 ? "#111" : "#fff";
}

// [red, green, blue] of an error, given as a share of the scale from -1 to 1.
export const errorColour = share => along(RAMPS.error[theme], (share + 1) / 2);
