// Beside the badge, what the set and the icon that is shown are predicted to do, and the goal of the set.

class Strip {
  /** `onGoal(text)` receives a goal that was typed. */
  constructor(onGoal, say) {
    Object.assign(this, { say, said: null, older: false, told: null, aimed: "" });
    const input = { type: "text", class: "tm-goal", placeholder: "90 % felt-and-named", title: "goal of the set, kept in its text", maxlength: 300 };
    const aim = () => {
      if (this.goal.value === this.aimed) return;
      this.aimed = this.goal.value;
      onGoal(this.aimed);
    };
    // In JupyterLab, Enter makes no change event.
    this.goal = make("input", { ...input, onchange: aim, onkeydown: ({ key }) => key === "Enter" && aim() });
    const number = () => make("b", {}, "–");
    Object.assign(this, { whole: number(), icon: number(), felt: number(), met: make("b", { class: "tm-met" }) });
    this.element = make("div", { class: "tm-strip", role: "group", "aria-label": "Predictions", "data-lm-suppress-shortcuts": "true" },
      make("span", {}, "felt and named: set ", this.whole, "icon ", this.icon), make("span", {}, "felt by ", this.felt),
      make("label", {}, "goal ", this.goal, this.met));
  }

  /** The numbers stay, pale; whether a goal is met is not known of another text. */
  age(older) {
    if (older === this.older) return;
    this.older = older;
    if (this.said) this.show(this.said);
  }

  show(given) {
    const older = this.older || given.stale;
    const nearly = given.rough ? "≈ " : "";
    for (const [part, name] of [[this.whole, "set"], [this.icon, "icon"], [this.felt, "felt"]]) {
      setText(part, given[name] === "–" ? "–" : nearly + given[name]);
    }
    if (given.goal !== (this.said?.goal ?? "")) this.goal.value = this.aimed = given.goal;
    const judged = older ? "? not judged" : { true: "✓ met", false: "✕ not met" }[given.met] ?? "?";
    setText(this.met, given.goal ? judged : "");
    this.met.title = older ? "" : given.binding;
    this.element.title = given.about;
    this.element.setAttribute("aria-label", older ? "Predictions, older than the text" : "Predictions");
    this.element.toggleAttribute("data-older", older);
    this.said = given;
    if (older || given.rough || !given.goal || this.told === given.met) return;
    this.told = given.met;
    this.say(`Goal ${given.met ? "met" : "not met"}. ${given.binding}`);
  }
}
