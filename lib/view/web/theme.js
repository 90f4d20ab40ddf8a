// Colours, read from the style sheet for use on the canvas.

const kColourNames = ["ground", "grid", "text", "soft", "tree", "trunk", "object", "unseen", "path", "gap", "way", "row",
  "mark", "scan"];

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

  colourOfKind(kind) {
    return [this.colours.tree, this.colours.object, this.colours.unseen, this.colours.trunk][kind];
  }
}
