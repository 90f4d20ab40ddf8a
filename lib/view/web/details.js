// Details of the selected landmark or gap.

function certaintyText(model, i) {
  const { label, probability } = model.columns;
  if (label[i] === kUnseen) return "not seen by the camera, or perhaps the ground";
  const sure = model.isTrunk(i) ? probability[i] : 1 - probability[i];
  const percent = sure > 0.999 ? "over 99.9 %" : `${(100 * sure).toFixed(1)} %`;
  return `${["sure", "likely", "unsure"][model.certainty(i)]}, ${percent}`;
}

function landmarkTitle(model, i) {
  const { row, position, id } = model.columns;
  if (position[i] > 0) return `Row ${model.rowName(row[i])}, tree ${position[i]}`;
  if (row[i] > 0) return `Row ${model.rowName(row[i])}, no number`;
  return `${model.kindTitle(i)}, #${id[i]}`;
}

// Rows of the details table: [name, value].
function landmarkFacts(model, i) {
  const c = model.columns;
  const width = c.width[i];
  const facts = [["Class", model.kindTitle(i)], ["Certainty", certaintyText(model, i)], ["Id", String(c.id[i])]];
  if (width > 0) {
    const name = model.isTrunk(i) ? "Trunk diameter" : "Width";
    const error = c.width_sd[i] > 0 ? ` ± ${(100 * c.width_sd[i]).toFixed(1)}` : "";
    facts.push([name, `${(100 * width).toFixed(1)} cm${error}`]);
    if (model.isTrunk(i)) {
      facts.push(["Girth", `${(100 * Math.PI * width).toFixed(1)} cm`]);
      facts.push(["Trunk cross-section", `${(2500 * Math.PI * width * width).toFixed(1)} cm²`]);
    }
  }
  if (model.isHedge(i)) facts.push(["Length", `${c.length[i].toFixed(1)} m`]);
  facts.push(["Position x, y", `${c.x[i].toFixed(3)}, ${c.y[i].toFixed(3)} m`]);
  if (c.z_sd[i] > 0) facts.push(["Height of the ground", `${c.z[i].toFixed(2)} ± ${c.z_sd[i].toFixed(2)} m`]);
  if (c.se_x[i] > 0 || c.se_y[i] > 0) {
    facts.push(["Standard error", `${(1000 * c.se_x[i]).toFixed(1)}, ${(1000 * c.se_y[i]).toFixed(1)} mm`]);
  }
  if (model.georeference && c.latitude[i]) {
    facts.push(["Latitude, longitude", `${c.latitude[i].toFixed(7)}, ${c.longitude[i].toFixed(7)}`]);
  }
  facts.push(["Observations", wholeNumber(c.n[i])], ["Mean confidence", c.roc[i].toFixed(3)]);
  const id = String(c.id[i]);
  if (Object.hasOwn(model.notes, id)) model.notes[id].forEach((words) => facts.push(["Note", words]));
  return facts;
}

class Details {
  // `select(index)` selects another landmark; `close()` clears the selection.
  constructor(model, theme, select, close) {
    this.model = model;
    this.theme = theme;
    this.select = select;
    this.close = close;
    this.box = byId("details");
    this.actions = () => []; // buttons for landmark i or for a gap of a row
    this.gapActions = () => [];
    this.beyond = null; // selects the next tree of a row where it is not loaded: (row, position, way)
  }

  hide() { this.box.hidden = true; }

  showLandmark(i) {
    const { model } = this;
    const steps = [];
    const { row, position } = model.columns;
    if (position[i] > 0) {
      for (const [words, way] of [["‹ before", -1], ["next ›", 1]]) {
        const [number, place] = [row[i], position[i]];
        const isAny = this.beyond !== null || this.neighbour(number, place, way) >= 0;
        const button = element("button", { type: "button", textContent: words, disabled: !isAny });
        button.addEventListener("click", () => {
          const other = this.neighbour(number, place, way);
          if (other >= 0) this.select(other); else if (this.beyond) this.beyond(number, place, way);
        });
        steps.push(button);
      }
    }
    this.show(landmarkTitle(model, i), this.theme.colourOfKind(model.look(i)), landmarkFacts(model, i), steps,
      this.photo(model.columns.id[i], landmarkTitle(model, i)), this.actions(i));
  }

  // Shows the photograph of a landmark, if the map has one.
  photo(id, title) {
    if (this.model.photoIds.has(id)) {
      return [element("img", { className: "photo", alt: `Photograph of ${title}`, src: this.photoAddress(id) })];
    }
    const jpeg = Object.hasOwn(this.model.photos, id) ? this.model.photos[id] : "";
    if (!/^[A-Za-z0-9+/]+=*$/.test(jpeg)) return [];
    return [element("img", { className: "photo", alt: `Photograph of ${title}`, src: `data:image/jpeg;base64,${jpeg}` })];
  }

  // On a disk, photographs of a large map are beside the page.
  photoAddress(id) { return location.protocol === "file:" ? `album/${id}.jpg` : `api/photo?id=${id}`; }

  showGap(row, gap) {
    const facts = [["Class", "Gap: place without a tree"], ["Position x, y", `${gap[1].toFixed(2)}, ${gap[2].toFixed(2)} m`]];
    this.show(`Row ${this.model.rowName(row.number)}, place ${gap[0]}`, this.theme.colours.gap, facts, [], [],
      this.gapActions(row, gap));
  }

  // The next tree of the row in one direction, skipping gaps.
  neighbour(row, position, way) {
    for (let k = 1; k <= 1000; ++k) {
      const i = this.model.at(row, position + way * k);
      if (i >= 0) return i;
    }
    return -1;
  }

  show(title, colour, facts, steps, pictures = [], actions = []) {
    const close = element("button", { type: "button", className: "icon", title: "Close", textContent: "×" });
    close.addEventListener("click", () => this.close());
    const swatch = element("span", { className: "swatch" });
    swatch.style.background = colour;
    const table = element("table", {}, ...facts.map(([what, value]) =>
      element("tr", {}, element("td", { textContent: what }), element("td", { textContent: value }))));
    this.box.replaceChildren(
      element("header", {}, swatch, element("div", {}, element("h2", { textContent: title })), close), ...pictures,
      ...(actions.length > 0 ? [element("div", { className: "steps actions" }, ...actions)] : []), table,
      ...(steps.length > 0 ? [element("div", { className: "steps" }, ...steps)] : []));
    this.box.hidden = false;
  }
}
