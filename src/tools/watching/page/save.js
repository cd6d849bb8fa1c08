// Saves a card's chart as PNG and its data as CSV.
import { set } from "./follower_chart.js";
import { label } from "./scale.js";

const MARGIN = 14, TITLE = 46;

function offer(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// The text of a CSV file: a heading and rows; null is empty.
const csvOf = ([heading, rows]) => [heading, ...rows.map(row => row.map(value => value ?? "").join())].join("\n") + "\n";

// An SVG as an image. Its styles come from the page's style sheet, which the image does not have: each element gets its own.
async function imageOf(svg) {
  const copy = svg.cloneNode(true), box = svg.getBoundingClientRect(), originals = svg.querySelectorAll("*");
  copy.querySelectorAll("*").forEach((element, at) => {
    const style = getComputedStyle(originals[at]);
    for (const name of ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "paint-order", "font-family", "font-size", "font-weight"])
      element.setAttribute(name, style.getPropertyValue(name));
  });
  set(copy, { xmlns: "http://www.w3.org/2000/svg", width: box.width, height: box.height });
  const image = new Image();
  image.src = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" }));
  await image.decode();
  URL.revokeObjectURL(image.src);
  return image;
}

// The card's charts below each other on the colour of the page, with the card's title and a line about the run.
async function pictureOf(card, about) {
  const charts = [...card.querySelectorAll("canvas, svg")], boxes = charts.map(chart => chart.getBoundingClientRect());
  const picture = document.createElement("canvas"), context = picture.getContext("2d"), scale = Math.max(window.devicePixelRatio, 2);
  picture.width = scale * (boxes[0].width + 2 * MARGIN);
  picture.height = scale * (TITLE + 2 * MARGIN + boxes.reduce((sum, box) => sum + box.height, 0));
  context.scale(scale, scale);
  const style = getComputedStyle(card);
  context.fillStyle = style.backgroundColor;
  context.fillRect(0, 0, picture.width, picture.height);
  label(context, card.querySelector("h2").textContent.replace(/\s+/g, " ").trim(), MARGIN, MARGIN + 14, "left", { colour: style.color, font: "600 15px" });
  label(context, about, MARGIN, MARGIN + 33, "left", { colour: style.color });
  let top = MARGIN + TITLE;
  for (const [at, chart] of charts.entries()) {
    context.drawImage(chart.tagName === "CANVAS" ? chart : await imageOf(chart), MARGIN, top, boxes[at].width, boxes[at].height);
    top += boxes[at].height;
  }
  return picture;
}

// Gives every card with a chart two buttons. `tableOf(card)` returns heading and rows, null without data; `about()` a line about
// the run.
export function offerSaving(tableOf, about) {
  for (const card of document.querySelectorAll("[data-saves]")) {
    const name = card.dataset.saves, box = card.querySelector("h2").appendChild(document.createElement("span"));
    box.className = "save";
    for (const kind of ["png", "csv"]) {
      const button = box.appendChild(document.createElement("button"));
      Object.assign(button, { type: "button", title: kind === "png" ? "save the chart as PNG" : "save its data as CSV" });
      button.dataset.kind = kind.toUpperCase();  // shown by the style sheet, so that it is no part of the title
      button.addEventListener("click", async () => {
        const table = tableOf(name);
        if (!table) return;
        if (kind === "csv") offer(new Blob([csvOf(table)], { type: "text/csv" }), `platoon-${name}.csv`);
        else (await pictureOf(card, about())).toBlob(content => offer(content, `platoon-${name}.png`));
      });
    }
  }
}
