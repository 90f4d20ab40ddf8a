// Overview of a large map: how many trees stand in each cell of a tile, as a shade.

const kShadeLeast = 0.4, kShadeMost = 0.95; // opacity of one tree in a cell, and of as many as any cell has

class TileShades {
  // `tiles`: the overview's part of the page's data.
  constructor(tiles) {
    const bytesOf = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    this.side = tiles.side;
    this.numCells = tiles.cells;
    this.trees = tiles.trees.map(bytesOf);
    this.others = tiles.others.map(bytesOf);
    this.most = this.trees.reduce((most, cells) => cells.reduce((more, count) => Math.max(more, count), most), 1);
    this.pictures = new Map();
    this.key = "";
  }

  // Draws tile `k`, whose lower left corner is (x, y) [m].
  paint(context, view, theme, shown, k, x, y) {
    const key = `${theme.colours.tree} ${theme.colours.object} ${shown.trees} ${shown.objects}`;
    if (key !== this.key) { this.key = key; this.pictures.clear(); }
    if (!this.pictures.has(k)) this.pictures.set(k, this.picture(k, theme, shown));
    const side_px = this.side * view.scale;
    context.drawImage(this.pictures.get(k), view.toScreenX(x), view.toScreenY(y + this.side), side_px, side_px);
  }

  picture(k, theme, shown) {
    const canvas = element("canvas", { width: this.numCells, height: this.numCells });
    const context = canvas.getContext("2d");
    const image = context.createImageData(this.numCells, this.numCells);
    const pixels = new Uint32Array(image.data.buffer);
    const fill = (counts, colour) => counts.forEach((count, cell) => {
      if (count === 0) return;
      const column = cell % this.numCells, row = this.numCells - 1 - (cell - column) / this.numCells;
      const fade = kShadeLeast + (kShadeMost - kShadeLeast) * Math.min(1, count / this.most);
      pixels[row * this.numCells + column] = pixelValue(colour, fade);
    });
    if (shown.objects) fill(this.others[k], theme.colours.object);
    if (shown.trees) fill(this.trees[k], theme.colours.tree); // a cell with both is a tree's
    context.putImageData(image, 0, 0);
    return canvas;
  }
}
