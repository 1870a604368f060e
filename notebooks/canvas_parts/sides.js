// A version that was pinned beside the present one: how well each set is felt and named, the icon's onset, the worst pair.

class Sides {
  /** `post` sends "pin" or "unpin", `ask` sends "swap", which changes what the page shows. */
  constructor(post, ask) {
    const button = (text, title, act) => make("button", { type: "button", class: "tm-button", title, onclick: act }, text);
    this.ask = ask;
    this.pin = button("Pin", "keep this version: its curves stay, pale, behind what comes next", () => post({ type: "pin" }));
    this.swap = button("⇄ Swap", "change sides with what is pinned (B on the time line)", () => this.change());
    this.drop = button("Unpin", "let the pinned version go", () => post({ type: "unpin" }));
    this.rows = make("tbody", {});
    const heads = ["version", "icon, rig", "felt and named", "of the icon", "onset, nominal", "worst pair"].map((head) => make("th", { scope: "col" }, head));
    this.table = make("table", { class: "tm-sides-table" }, make("caption", { class: "tm-unseen" }, "Pinned and present version"), make("thead", {}, make("tr", {}, ...heads)), this.rows);
    this.element = make("div", { class: "tm-sides", role: "group", "aria-label": "Versions" }, this.table, this.swap, this.drop);
    this.show([]);
  }

  change() {
    if (!this.any) return false;
    this.ask({ type: "swap", once: nextSeq() }); // asked again after silence, it must not change sides twice
    return true;
  }

  /** `sides`: what is pinned and what is present, each with its words; none where nothing is pinned. */
  show(sides) {
    this.any = sides.length > 0;
    this.element.hidden = !this.any;
    const looks = JSON.stringify(sides);
    if (looks === this.looks) return;
    this.looks = looks;
    this.rows.replaceChildren(...sides.map(({ side, what, set, icon, onset, worst, stale }) =>
      make("tr", { "data-older": stale }, make("th", { scope: "row" }, side), ...[what, set, icon, onset, worst].map((text) => make("td", { title: text }, text)))));
  }
}
