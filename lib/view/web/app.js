// The page: holds the map and the selection, and updates the other parts when something changes.

class App {
  constructor(data) {
    this.data = data;
    this.model = new MapModel(data);
    this.view = new Viewport();
    this.canvas = byId("map");
    this.selectedId = null;
    this.theme = new Theme(() => this.recolour());
    this.painter = new Painter(this.canvas, this.model, this.view, this.theme);
    this.details = new Details(this.model, this.theme, (i) => this.select(i, true), () => this.select(-1));
    this.gestures = new Gestures(this.canvas, this.view, () => this.redraw(), (...all) => this.click(...all));
    this.tiles = null;
    new ResizeObserver(() => { this.painter.resize(); this.paintNow(); }).observe(this.canvas);
    this.wireButtons();
    this.painter.resize();
    this.setMenu(this.view.width > 640);
    if (data.tiles) this.tiles = new Tiles(this);
    this.model.backgroundCame = () => this.redraw();
    this.showAll();
    this.here = new Here(this);
    this.tasks = new Tasks(this);
    let isPrinted = false;
    this.painter.overlays.push((context, view, theme) => { if (isPrinted) paintScale(context, view, theme); });
    for (const name of ["beforeprint", "afterprint"]) {
      window.addEventListener(name, () => { isPrinted = name === "beforeprint"; this.fit(); this.paintNow(); });
    }
    this.fit();
  }

  wireButtons() {
    const zoom = (factor) => { this.view.zoomAt(this.view.width / 2, this.view.height / 2, factor); this.redraw(); };
    byId("zoom-in").addEventListener("click", () => zoom(1.6));
    byId("zoom-out").addEventListener("click", () => zoom(1 / 1.6));
    byId("fit").addEventListener("click", () => this.fit());
    byId("theme").addEventListener("click", () => this.theme.toggle());
    byId("menu-button").addEventListener("click", () => this.setMenu(byId("menu").hidden));
    byId("search").addEventListener("submit", (event) => { event.preventDefault(); this.search(byId("query").value); });
    document.addEventListener("keydown", (event) => { if (event.key === "Escape") { this.select(-1); this.canvas.focus(); } });
  }

  takeCorrections(event) {
    this.model.setNames(event.row_names, event.notes);
    showCorrections(event.list);
    if (this.editor) this.editor.show(event);
  }

  // Updates the lists and the details of the selection after the map has changed.
  refreshLists() {
    showSummary(this.model, this.data);
    showRows(this.model, (row) => this.showRow(row), this.editor && ((row) => this.editor.renameRow(row)));
    this.refreshDetails();
    this.redraw();
  }

  refreshDetails() {
    if (this.selectedId === null) return;
    const i = this.model.withId(this.selectedId);
    if (i >= 0) this.details.showLandmark(i); else this.select(-1);
  }

  setMenu(isOpen) {
    byId("menu").hidden = !isOpen;
    byId("menu-button").setAttribute("aria-expanded", String(isOpen));
  }

  // Updates everything except the canvas after the map has changed.
  showAll() {
    showSummary(this.model, this.data);
    showLegend(this.theme, this.painter.shown, this.model, () => this.redraw());
    showRows(this.model, (row) => this.showRow(row));
    showNorth(this.model.georeference);
    this.redraw();
  }

  recolour() {
    if (!this.painter) return; // during construction
    showLegend(this.theme, this.painter.shown, this.model, () => this.redraw());
    this.redraw();
  }

  redraw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.paintNow());
  }

  paintNow() {
    this.isDue = false;
    if (this.tiles) this.tiles.update();
    this.painter.selected = this.selectedId === null ? -1 : this.model.withId(this.selectedId);
    this.painter.paint();
    showScale(this.view);
  }

  // Margins covered by the panels [px].
  insets() {
    if (this.view.width <= 640) {
      const details = byId("details");
      return { left: 16, right: 62, top: byId("head").offsetHeight + 40, bottom: Math.max(50, details.offsetHeight + 16, byId("live").offsetHeight + byId("player").offsetHeight + 16) };
    }
    return { left: 350, right: byId("details").hidden && byId("live").hidden ? 70 : 384, top: 30, bottom: 30 + byId("player").offsetHeight };
  }

  fit() {
    const box = this.model.box;
    if (box) this.view.fit(box, this.insets());
    this.redraw();
  }

  showRow(row) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = 0; k + 1 < row.line.length; k += 2) {
      box[0] = Math.min(box[0], row.line[k]); box[1] = Math.min(box[1], row.line[k + 1]);
      box[2] = Math.max(box[2], row.line[k]); box[3] = Math.max(box[3], row.line[k + 1]);
    }
    this.view.fit(box, this.insets());
    this.redraw();
  }

  // Selects landmark i (-1: none); `isMoving`: also centres it.
  select(i, isMoving = false) {
    this.painter.selectedGap = null;
    this.selectedId = i >= 0 ? this.model.columns.id[i] : null;
    if (i >= 0) {
      this.details.showLandmark(i);
      if (isMoving) this.goTo(this.model.columns.x[i], this.model.columns.y[i]);
    } else {
      this.details.hide();
    }
    if (this.here) this.here.show();
    this.redraw();
  }

  selectGap(row, gap, isMoving = false) {
    this.select(-1);
    this.painter.selectedGap = gap;
    this.details.showGap(row, gap);
    if (isMoving) this.goTo(gap[1], gap[2]);
  }

  goTo(x, y) {
    this.view.scale = Math.max(this.view.scale, 24);
    this.view.centreOn(x, y, this.insets());
    this.redraw();
  }

  click(sx, sy, isKey = false) {
    const x = this.view.toMapX(sx), y = this.view.toMapY(sy);
    const within_m = (isKey ? Math.max(this.view.width, this.view.height) : 16) / this.view.scale;
    if (this.here.takeClick(x, y)) return;
    const i = this.model.nearest(x, y, within_m);
    if (this.editor && this.editor.takeClick(x, y, i)) return;
    if (i >= 0) {
      this.select(i);
      if (isKey) byId("details").querySelector("button").focus();
      return;
    }
    for (const row of this.model.rows) {
      const gap = row.gaps.find((other) => Math.hypot(other[1] - x, other[2] - y) <= within_m);
      if (gap) { this.selectGap(row, gap); return; }
    }
    this.select(-1);
  }

  search(text) {
    if (!this.tiles) { this.showFound(text); return; }
    this.tiles.loadFor(parseQuery(this.model, text)).then(() => this.showFound(text), (error) => this.tiles.fail(error));
  }

  showFound(text) {
    const found = findInMap(this.model, text);
    byId("found").textContent = found.words || "";
    if (found.index !== undefined) this.select(found.index, true);
    else if (found.gap) this.selectGap(found.row, found.gap, true);
    else if (found.wholeRow) this.showRow(found.wholeRow);
    if (!found.words) byId("query").blur();
  }
}
