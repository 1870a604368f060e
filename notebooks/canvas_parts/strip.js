// Beside the badge, what the set and the icon that is shown are predicted to do, and the goal of the set.

class Strip {
  /** `onGoal(text)` receives a goal that was typed. */
  constructor(onGoal, say) {
    Object.assign(this, { say, said: null });
    const input = { type: "text", class: "tm-goal", placeholder: "90 % felt-and-named", title: "goal of the set, kept in its text", maxlength: 300 };
    this.goal = make("input", { ...input, onchange: () => onGoal(this.goal.value) });
    const number = () => make("b", {}, "–");
    Object.assign(this, { whole: number(), icon: number(), felt: number(), met: make("b", { class: "tm-met" }) });
    this.element = make("div", { class: "tm-strip", role: "group", "aria-label": "Predictions", "data-lm-suppress-shortcuts": "true" },
      make("span", {}, "set ", this.whole, " felt and named"), make("label", {}, "goal ", this.goal, this.met),
      make("span", {}, "icon ", this.icon, " felt and named, felt by ", this.felt));
  }

  show(given) {
    const nearly = given.rough ? "≈ " : "";
    for (const [part, name] of [[this.whole, "set"], [this.icon, "icon"], [this.felt, "felt"]]) {
      setText(part, given[name] === "–" ? "–" : nearly + given[name]);
    }
    if (given.goal !== this.said?.goal) this.goal.value = given.goal;
    setText(this.met, { true: "✓ met", false: "✕ not met" }[given.met] ?? (given.goal ? "?" : ""));
    this.met.title = given.binding;
    this.element.title = given.about;
    this.element.classList.toggle("tm-old", given.stale);
    Object.assign(this.element.dataset, { stale: given.stale, rough: given.rough });
    if (!given.stale && !given.rough && this.said?.met !== given.met && given.goal) this.say(`Goal ${given.met ? "met" : "not met"}. ${given.binding}`);
    this.said = given;
  }
}
