// Colours, read from the style sheet for use on the canvas.

const kColourNames = ["ground", "grid", "text", "soft", "tree", "trunk", "object", "unseen", "path", "gap", "way", "row",
  "mark", "scan", "low", "high"];

class Theme {
  constructor(onChange) {
    this.onChange = onChange;
    this.prefersDark = matchMedia("(prefers-color-scheme: dark)");
    this.prefersDark.addEventListener("change", () => this.apply(this.prefersDark.matches));
    this.apply(this.prefersDark.matches);
  }

  apply(isDark) {
    this.isDark = isDark;
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    this.colours = {};
    for (const name of kColourNames) this.colours[name] = style.getPropertyValue(`--${name}`).trim();
    this.onChange();
  }

  toggle() { this.apply(!this.isDark); }

  // Of a part of the way from the lowest ground to the highest.
  colourOfHeight(part) {
    return `color-mix(in srgb, ${this.colours.high} ${Math.round(100 * part)}%, ${this.colours.low})`;
  }

  colourOfKind(kind) {
    return [this.colours.tree, this.colours.object, this.colours.unseen, this.colours.trunk][kind];
  }
}
