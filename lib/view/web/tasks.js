// Tasks of `orchard tasks`: opened from their GeoJSON, ticked here, saved as such again.

class Tasks {
  constructor(app) {
    this.app = app;
    this.file = null; // the GeoJSON as it was read, with states as ticked
    byId("tasks-box").hidden = !app.model.georeference;
    byId("tasks-file").addEventListener("change", (event) => this.open(event.target.files[0]));
    byId("tasks-save").addEventListener("click", () => this.save());
    window.addEventListener("beforeunload", (event) => { if (this.isUnsaved) event.preventDefault(); });
    app.painter.overlays.push((context, view, theme) => this.paint(context, view, theme));
  }

  async open(file) {
    if (!file) return;
    try {
      this.take(JSON.parse(await file.text()), file.name);
    } catch (error) {
      byId("found").textContent = `${file.name} is not a file of tasks: ${error.message}`;
    }
  }

  take(read, name) {
    const list = read.features.map((feature) => {
      const place = placeOf(this.app.model, feature.geometry.coordinates[1], feature.geometry.coordinates[0]);
      if (!place || !place.every(Number.isFinite)) throw new Error("a task without a place");
      return { properties: feature.properties, place };
    });
    if (list.some(({ properties }) => !["open", "done"].includes(properties.state))) throw new Error("a state that is not open or done");
    this.file = read;
    this.list = list;
    this.name = name;
    this.isUnsaved = false;
    byId("tasks").replaceChildren(...list.map((task) => this.line(task)));
    this.show();
  }

  line(task) {
    const { properties } = task;
    const box = element("input", { type: "checkbox", checked: properties.state === "done" });
    box.addEventListener("change", () => {
      properties.state = box.checked ? "done" : "open";
      this.isUnsaved = true;
      this.show();
    });
    const at = properties.tree ? ` ${properties.row}/${properties.tree}` : "";
    const words = `${properties.what}${at}: ${[properties.why, properties.since, properties.note].filter((text) => text).join(", ")}`;
    box.ariaLabel = words;
    const button = element("button", { type: "button", textContent: words });
    button.addEventListener("click", () => this.app.goTo(...task.place));
    return element("li", {}, box, " ", button);
  }

  show() {
    const numOpen = this.list.filter(({ properties }) => properties.state === "open").length;
    byId("tasks-words").textContent = `${wholeNumber(numOpen)} of ${wholeNumber(this.list.length)} open` +
      (this.isUnsaved ? "; not saved" : "");
    byId("tasks-save").hidden = false;
    this.app.redraw();
  }

  save() {
    const bytes = new Blob([JSON.stringify(this.file)], { type: "application/geo+json" });
    const link = element("a", { href: URL.createObjectURL(bytes), download: this.name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000); // a telephone takes its time
    this.isUnsaved = false;
    this.show();
  }

  paint(context, view, theme) {
    for (const { properties, place } of this.list || []) {
      context.beginPath();
      context.arc(view.toScreenX(place[0]), view.toScreenY(place[1]), 9, 0, 2 * Math.PI);
      context.strokeStyle = properties.state === "open" ? theme.colours.mark : theme.colours.path;
      context.lineWidth = properties.state === "open" ? 3 : 1.5;
      context.stroke();
    }
  }
}
