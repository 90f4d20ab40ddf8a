// The map's content in columns: column[i] belongs to landmark i.

// Kinds: a tree is a trunk in a row; in a map without rows, such as of a park, there are trunks only.
const kTree = 0, kObject = 1, kUnseen = 2, kTrunk = 3, kNumKinds = 4;
const kClassNames = ["tree", "object", "unseen", "tree"];
const kKindTitles = ["Tree", "Object", "Not classified yet", "Trunk in no row"];

// Size of the index's cells, such that a cell contains a few trees.
const kCell_m = 8;

// Distance from a point to the line segment a-b.
function distanceToLine({ ax, ay, bx, by }, x, y) {
  const dx = bx - ax, dy = by - ay;
  const part = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / Math.max(1e-9, dx * dx + dy * dy)));
  return Math.hypot(x - ax - part * dx, y - ay - part * dy);
}

class MapModel {
  constructor(data) {
    this.columns = {};
    for (const name of MapModel.columnNames) this.columns[name] = [];
    this.indexOfId = new Map();
    this.rows = [];
    this.ways = [];
    this.paths = [];
    this.tiles = null; // of a large map
    this.totals = null; // its numbers by class
    this.rowLines_ = null;
    this.revision = 0;
    this.replace(data);
  }

  // Loads a complete map as written by the program.
  replace(data) {
    for (const name of MapModel.columnNames) this.columns[name] = (data.landmarks[name] || []).slice();
    this.indexOfId = new Map(this.columns.id.map((id, i) => [id, i]));
    this.paths = data.paths || [];
    this.georeference = data.georeference || null;
    if (data.background) this.setBackground(data.background);
    this.photos = data.photos || {};
    this.photoIds = new Set(data.photo_ids || []);
    this.setNames(data.row_names || {}, data.notes || {});
    this.setRows(data.rows || [], data.ways || []);
  }

  // A picture from above beneath the map; it is there a moment later.
  setBackground({ box, jpeg }) {
    const image = new Image();
    image.addEventListener("load", () => {
      this.background = { image, box };
      this.revision++;
      this.backgroundCame?.();
    });
    image.src = "data:image/jpeg;base64," + jpeg;
    this.hasBackground = true;
  }

  // The overview of a large map in `tiles`: lines and numbers, without landmarks.
  setOverview(overview, tiles) {
    this.tiles = tiles;
    this.overview = overview;
    this.totals = overview.tiles.counts;
    this.setRows(overview.rows, overview.ways);
  }

  // Shows the landmarks and gaps of these tiles, and their lines or those of the overview.
  showTiles(tiles, isNear) {
    for (const name of MapModel.columnNames) {
      this.columns[name] = tiles.flatMap((tile) => tile.landmarks[name] || new Array(tile.landmarks.id.length).fill(0));
    }
    this.indexOfId = new Map(this.columns.id.map((id, i) => [id, i]));
    const rows = new Map(this.rows.map((row) => [row.number, row]));
    for (const row of this.rows) row.gaps = [];
    for (const tile of tiles) for (const [row, ...gap] of tile.gaps) rows.get(row)?.gaps.push(gap);
    this.rowLines_ = isNear ? tiles.flatMap((tile) => tile.rows) : null;
    this.ways = isNear ? tiles.flatMap((tile) => tile.ways) : this.overview.ways;
    this.paths = isNear ? tiles.flatMap((tile) => tile.paths) : this.overview.paths;
    this.touch();
  }

  get rowLines() { return this.rowLines_ || this.rows.map((row) => row.line); }

  // Sets the names of rows by number and the notes of landmarks by id.
  setNames(rowNames, notes) {
    this.rowNames = rowNames;
    this.notes = notes;
    this.touch();
  }

  rowName(row) { return Object.hasOwn(this.rowNames, row) ? this.rowNames[row] : String(row); }

  setRows(rows, ways) {
    this.rows = rows;
    this.ways = ways;
    this.touch();
  }

  // Adds or changes one landmark; missing values remain unchanged.
  put(values) {
    let i = this.indexOfId.get(values.id);
    if (i === undefined) {
      i = this.columns.id.length;
      this.indexOfId.set(values.id, i);
      for (const name of MapModel.columnNames) this.columns[name].push(0);
    }
    for (const name of MapModel.columnNames) {
      if (values[name] !== undefined) this.columns[name][i] = values[name];
    }
    this.touch();
  }

  // Removes a landmark; the last one takes its place, so that columns have no gaps.
  remove(id) {
    const i = this.indexOfId.get(id);
    if (i === undefined) return;
    const last = this.columns.id.length - 1;
    for (const name of MapModel.columnNames) {
      this.columns[name][i] = this.columns[name][last];
      this.columns[name].pop();
    }
    this.indexOfId.delete(id);
    if (i !== last) this.indexOfId.set(this.columns.id[i], i);
    this.touch();
  }

  touch() {
    this.revision += 1;
    this.cells_ = null;
    this.counts_ = null;
    this.styles_ = null;
    this.byPlace_ = null;
    this.hedges_ = null;
    this.box_ = null;
    this.heights_ = undefined;
  }

  // The lowest and the highest ground at landmarks whose height is known; null without any. Tiles
  // of a large map tell of their part only.
  get heights() {
    if (this.heights_ === undefined) {
      const { z, z_sd } = this.columns;
      let low = Infinity, high = -Infinity;
      for (let i = 0; i < this.count; ++i) {
        if (!(z_sd[i] > 0)) continue;
        low = Math.min(low, z[i]); high = Math.max(high, z[i]);
      }
      this.heights_ = low <= high && !this.tiles ? { low, high } : null;
    }
    return this.heights_;
  }

  // Hedges and walls as centre lines: { i, ax, ay, bx, by }.
  get hedges() {
    if (!this.hedges_) {
      const { x, y, width, length, direction } = this.columns;
      this.hedges_ = [];
      length.forEach((long, i) => {
        if (!(long > 0)) return;
        const half = Math.max(0, long - width[i]) / 2;
        const dx = half * Math.cos(direction[i]), dy = half * Math.sin(direction[i]);
        this.hedges_.push({ i, ax: x[i] - dx, ay: y[i] - dy, bx: x[i] + dx, by: y[i] + dy });
      });
    }
    return this.hedges_;
  }

  isHedge(i) { return this.columns.length[i] > 0; }

  get count() { return this.columns.id.length; }

  numberOf(kind) {
    if (this.totals) return this.totals[kind];
    if (!this.counts_) {
      this.counts_ = new Array(kNumKinds).fill(0);
      for (const other of this.columns.label) ++this.counts_[other];
    }
    return this.counts_[kind];
  }

  get hasTrees() { return this.numberOf(kTree) > 0; }

  isTrunk(i) { return this.columns.label[i] === kTree || this.columns.label[i] === kTrunk; }

  // The kind that a landmark looks like: without rows, trunks look like trees.
  look(i) {
    const kind = this.columns.label[i];
    return kind === kTrunk && !this.hasTrees ? kTree : kind;
  }

  kindTitle(i) {
    const kind = this.columns.label[i];
    return kind === kTrunk && !this.hasTrees ? "Trunk" : kKindTitles[kind];
  }

  get numGaps() { return this.rows.reduce((sum, row) => sum + MapModel.numGapsOf(row), 0); }

  static numGapsOf(row) { return row.num_gaps === undefined ? row.gaps.length : row.num_gaps; }

  // Certainty of the class: 0 sure, 1 likely, 2 unsure.
  certainty(i) {
    const p = this.columns.probability[i];
    const sure = this.isTrunk(i) ? p : 1 - p;
    return sure >= 0.9 ? 0 : sure >= 0.7 ? 1 : 2;
  }

  // Indices by look and certainty, for drawing them together: styles[3 * look + certainty].
  get styles() {
    if (!this.styles_) {
      this.styles_ = Array.from({ length: 3 * kNumKinds }, () => []);
      for (let i = 0; i < this.count; ++i) {
        const look = this.look(i);
        this.styles_[3 * look + (look === kUnseen ? 0 : this.certainty(i))].push(i);
      }
    }
    return this.styles_;
  }

  // Bounding box of everything: [x min, y min, x max, y max], or null for an empty map.
  get box() {
    if (this.totals) return this.overview.tiles.box || null;
    if (this.box_) return this.box_;
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const add = (x, y) => {
      box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
    };
    for (let i = 0; i < this.count; ++i) add(this.columns.x[i], this.columns.y[i]);
    for (const hedge of this.hedges) { add(hedge.ax, hedge.ay); add(hedge.bx, hedge.by); }
    for (const path of this.paths) for (let k = 0; k + 1 < path.length; k += 2) add(path[k], path[k + 1]);
    this.box_ = box[0] <= box[2] ? box : null;
    return this.box_;
  }

  get cells() {
    if (!this.cells_) {
      this.cells_ = new Map();
      for (let i = 0; i < this.count; ++i) {
        const key = MapModel.cellKey(this.columns.x[i], this.columns.y[i]);
        const cell = this.cells_.get(key);
        if (cell) cell.push(i); else this.cells_.set(key, [i]);
      }
    }
    return this.cells_;
  }

  static cellKey(x, y) {
    return (Math.floor(x / kCell_m) + 1e6) * 4e6 + Math.floor(y / kCell_m) + 1e6;
  }

  // Indices in a box, or null if it covers so many cells that checking all landmarks is as fast.
  inBox(box) {
    const wide = (box[2] - box[0]) / kCell_m + 1, high = (box[3] - box[1]) / kCell_m + 1;
    if (wide * high > this.cells.size) return null;
    const found = [];
    for (let x = box[0] - kCell_m; x < box[2] + kCell_m; x += kCell_m) {
      for (let y = box[1] - kCell_m; y < box[3] + kCell_m; y += kCell_m) {
        const cell = this.cells.get(MapModel.cellKey(x, y));
        if (cell) for (const i of cell) found.push(i);
      }
    }
    return found;
  }

  // The nearest landmark within a distance; otherwise a hedge at this position; -1 for none.
  nearest(x, y, within_m) {
    const near = this.inBox([x - within_m, y - within_m, x + within_m, y + within_m]);
    let best = -1, least = within_m * within_m;
    const look = (i) => {
      const dx = this.columns.x[i] - x, dy = this.columns.y[i] - y;
      if (dx * dx + dy * dy <= least) { least = dx * dx + dy * dy; best = i; }
    };
    if (near) near.forEach(look); else for (let i = 0; i < this.count; ++i) look(i);
    if (best >= 0) return best;
    const covering = this.hedges.find((hedge) => distanceToLine(hedge, x, y) <= this.columns.width[hedge.i] / 2);
    return covering ? covering.i : -1;
  }

  // The tree with that row and position; -1 for none.
  at(row, position) {
    if (!this.byPlace_) {
      this.byPlace_ = new Map();
      for (let i = 0; i < this.count; ++i) {
        if (this.columns.row[i] > 0) this.byPlace_.set(`${this.columns.row[i]}/${this.columns.position[i]}`, i);
      }
    }
    const i = this.byPlace_.get(`${row}/${position}`);
    return i === undefined ? -1 : i;
  }

  withId(id) {
    const i = this.indexOfId.get(id);
    return i === undefined ? -1 : i;
  }

  rowOfNumber(number) { return this.rows.find((row) => row.number === number) || null; }
}

MapModel.columnNames = ["id", "label", "x", "y", "n", "roc", "probability", "se_x", "se_y", "width", "width_sd", "row",
  "position", "latitude", "longitude", "length", "direction", "z", "z_sd"];
