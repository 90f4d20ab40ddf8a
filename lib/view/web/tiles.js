// A map of too many landmarks for one page: an overview, and tiles that are loaded when they are in
// view, from the page's server or, of a page on a disk, from the files beside it.

const kTiledMost = 60000; // landmarks in view up to which tiles are loaded: a browser pans over 100,000
const kTilesKept = 64; // loaded tiles that are kept for the way back

class Tiles {
  constructor(app) {
    this.app = app;
    this.isServed = app.data.mode === "folder";
    this.loaded = new Map(); // by name, the latest one used last
    this.pending = new Map(); // promises by name
    this.arrived = new Map(); // by name, from scripts
    this.pinned = []; // names of tiles that a search or a step along a row needs
    this.renew(app.data);
    app.details.beyond = (row, position, way) => this.step(row, position, way);
    if (!this.isServed) globalThis.orchardTile = (name, tile) => this.arrived.set(name, tile);
  }

  // Begins anew with an overview, as after a correction.
  renew(overview) {
    const { tiles } = overview;
    Object.assign(this, { stamp: tiles.stamp, side: tiles.side, names: [], places: [], index: null, shown: null });
    for (let k = 0; k + 2 < tiles.places.length; k += 3) {
      const [column, row, count] = tiles.places.slice(k, k + 3);
      this.names.push(`${column}_${row}`);
      this.places.push({ x: column * tiles.side, y: row * tiles.side, count });
    }
    this.shades = new TileShades(tiles);
    this.loaded.clear();
    this.app.model.setOverview(overview, this);
    this.app.redraw();
  }

  // Numbers of the tiles in the view and its margin; none while these have too many landmarks.
  inView() {
    const { view } = this.app;
    const [left, low, right, high] = view.box(kSceneMargin * Math.max(view.width, view.height));
    const found = [];
    let count = 0;
    this.places.forEach((place, k) => {
      if (place.x > right || place.y > high || place.x + this.side < left || place.y + this.side < low) return;
      found.push(k);
      count += place.count;
    });
    return count <= kTiledMost ? found : [];
  }

  // Shows the tiles in view that are loaded, and loads the others.
  update() {
    const inView = this.inView();
    const wanted = [...new Set([...inView.map((k) => this.names[k]), ...this.pinned])];
    for (const name of wanted) {
      const tile = this.loaded.get(name);
      if (!tile) { this.load(name).then(() => this.app.redraw(), (error) => this.fail(error)); continue; }
      this.loaded.delete(name);
      this.loaded.set(name, tile);
    }
    const shown = wanted.filter((name) => this.loaded.has(name)).sort();
    const key = `${inView.length > 0} ${shown.join()}`;
    if (this.shown && key === this.shownKey) return;
    this.shown = shown;
    this.shownKey = key;
    this.app.model.showTiles(shown.map((name) => this.loaded.get(name)), inView.length > 0);
  }

  fail(error) { byId("found").textContent = error.message; }

  // A promise that is kept when the tile is loaded.
  load(name) {
    if (this.loaded.has(name)) return Promise.resolve();
    if (!this.pending.has(name)) {
      const { stamp } = this;
      this.pending.set(name, this.fetch(name).then((tile) => {
        if (stamp !== this.stamp) return; // an older map's
        if (tile.stamp !== stamp) throw new Error("This page and its tiles are of different maps. Load it again.");
        this.loaded.set(name, tile);
        for (const old of this.loaded.keys()) {
          if (this.loaded.size <= kTilesKept) break;
          if (!(this.shown || []).includes(old)) this.loaded.delete(old);
        }
      }).finally(() => this.pending.delete(name)));
    }
    return this.pending.get(name);
  }

  async fetch(name) {
    if (this.isServed) {
      const answer = await fetch(`api/tile?name=${name}`);
      if (!answer.ok) throw new Error(`A part of the map could not be loaded (${answer.status}). Load the page again.`);
      return answer.json();
    }
    // A page on a disk may load no data, but scripts: each tile is one that hands over its content.
    return new Promise((done, fail) => {
      const script = element("script", { src: `map_tiles/${name}.js` });
      script.addEventListener("load", () => { script.remove(); done(this.arrived.get(name)); this.arrived.delete(name); });
      script.addEventListener("error", () => {
        script.remove();
        fail(new Error("A part of the map is missing: map.html needs its folder map_tiles beside it."));
      });
      document.head.append(script);
    });
  }

  // Which tiles have which ids and places; loaded at the first search.
  async loadIndex() {
    if (!this.index) this.index = await this.fetch("index");
    return this.index;
  }

  // The number of the tile with this id or position, in runs [first, tile, first, tile ...].
  static tileOf(runs, number) {
    let tile = -1;
    for (let k = 0; k + 1 < runs.length && runs[k] <= number; k += 2) tile = runs[k + 1];
    return tile;
  }

  // Loads and shows the tiles of these numbers besides those in view.
  async pin(numbers) {
    const names = numbers.filter((k) => k >= 0).map((k) => this.names[k]);
    await Promise.all(names.map((name) => this.load(name)));
    this.pinned = names;
    this.update();
  }

  // Loads what a query asks for.
  async loadFor(query) {
    if (!query || (query.id === undefined && query.position === undefined)) return;
    const { ids, rows } = await this.loadIndex();
    const runs = query.id !== undefined ? ids : rows[query.row] || [];
    await this.pin([Tiles.tileOf(runs, query.id !== undefined ? query.id : query.position)]);
  }

  // Selects the next tree of a row in one direction, in whichever tile it is.
  async step(row, position, way) {
    const { app } = this;
    const runs = (await this.loadIndex()).rows[row] || [];
    const first = runs.length > 0 ? runs[0] : 0;
    let tiles = [];
    for (let k = 0; k + 1 < runs.length; k += 2) {
      const next = k + 2 < runs.length ? runs[k + 2] : Infinity;
      if (way > 0 ? next > position + 1 : runs[k] < position) tiles.push(runs[k + 1]);
    }
    if (way < 0) tiles = tiles.reverse();
    for (const tile of position + way < first ? [] : tiles) {
      await this.pin([tile]);
      const i = app.details.neighbour(row, position, way);
      if (i >= 0) { app.select(i, true); return; }
    }
    byId("found").textContent = `Row ${app.model.rowName(row)} has no tree further on.`;
  }

  // Draws the shades of all tiles whose landmarks are not shown.
  paintShades(context, view, theme, shown) {
    const isShown = new Set(this.shown || []);
    this.places.forEach((place, k) => {
      if (!isShown.has(this.names[k])) this.shades.paint(context, view, theme, shown, k, place.x, place.y);
    });
  }
}
