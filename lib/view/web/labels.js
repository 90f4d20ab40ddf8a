// Text on the map: labels placed first stay, later ones that would overlap them are omitted.

class LabelPlacer {
  constructor(context) {
    this.context = context;
    this.taken = new Map(); // occupied boxes by coarse cell
  }

  isFree(box) {
    return this.cellsOf(box).every((key) => (this.taken.get(key) || []).every(
      (other) => box[2] < other[0] || other[2] < box[0] || box[3] < other[1] || other[3] < box[1]));
  }

  take(box) {
    for (const key of this.cellsOf(box)) {
      if (this.taken.has(key)) this.taken.get(key).push(box); else this.taken.set(key, [box]);
    }
  }

  cellsOf(box) {
    const keys = [];
    for (let x = Math.floor(box[0] / 64); x <= Math.floor(box[2] / 64); ++x) {
      for (let y = Math.floor(box[1] / 64); y <= Math.floor(box[3] / 64); ++y) keys.push(x * 4096 + y);
    }
    return keys;
  }

  // Writes `text` centred at a position unless it would overlap another; returns whether it was
  // written.
  write(text, sx, sy, colour, halo, chip) {
    const context = this.context;
    const half = context.measureText(text).width / 2 + (chip ? 6 : 2), high = chip ? 10 : 7;
    const box = [sx - half, sy - high, sx + half, sy + high];
    if (!this.isFree(box)) return false;
    this.take(box);
    if (chip) {
      context.beginPath();
      context.roundRect(box[0], box[1], 2 * half, 2 * high, 9);
      context.fillStyle = chip;
      context.fill();
    } else {
      context.lineWidth = 3;
      context.strokeStyle = halo;
      context.lineJoin = "round";
      context.strokeText(text, sx, sy);
    }
    context.fillStyle = colour;
    context.fillText(text, sx, sy);
    return true;
  }
}

// Whether a line [x, y, x, y ...] is closer to vertical than to horizontal.
function isUpright(line) {
  const last = line.length - 2;
  return Math.abs(line[last + 1] - line[1]) >= Math.abs(line[last] - line[0]);
}

// Label step (every n-th number) for that distance between neighbours on the canvas.
function labelStep(spacing_px) {
  return [1, 2, 5, 10, 20, 50, 100].find((step) => step * spacing_px >= 30) || 0;
}
