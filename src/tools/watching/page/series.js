// Series that the reader hides: a button of a legend shows or hides its series in the chart of its card.

const FIELDS = {
  measured: ["mean", "variance", "standard_error", "provisional"], errors: ["standard_error"], theory: ["theoretical_mean", "theoretical_variance"], limit: ["limit_variance"],
  smallest: ["smallest_gap"], collisions: ["collisions"],
};
const PER_FOLLOWER = ["mean", "variance", "theoretical_mean", "theoretical_variance"];

const nothing = values => Array.isArray(values) ? values.map(nothing) : null;

export class Series {
  constructor(changed) {
    this.hidden = {};
    for (const button of document.querySelectorAll("[data-series]")) {
      const card = button.closest("[data-saves]").dataset.saves, hidden = this.hidden[card] ??= new Set();
      button.setAttribute("aria-pressed", true);
      button.title ||= "show or hide";
      button.addEventListener("click", () => {
        const name = button.dataset.series;
        if (!hidden.delete(name)) hidden.add(name);
        button.setAttribute("aria-pressed", !hidden.has(name));
        changed(card);
      });
    }
  }

  // The card's data with null in place of hidden values.
  shown(card, of, chosen) {
    const fields = [...this.hidden[card]].flatMap(name => FIELDS[name] ?? []), alone = chosen && this.hidden[card].has("others");
    const kept = (name, values) => fields.includes(name) ? nothing(values) : alone && PER_FOLLOWER.includes(name) ?
      values.map((row, at) => of.followers[at] === chosen ? row : nothing(row)) : values;
    return Object.fromEntries(Object.entries(of).map(([name, values]) => [name, kept(name, values)]));
  }
}
