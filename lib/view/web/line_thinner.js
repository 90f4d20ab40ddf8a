// Simplifies a line on the canvas: omits points that are less than half a pixel from the straight
// line between the points kept.

const kThin_px = 0.5;

class LineThinner {
  constructor() {
    this.pen = null; // last point kept
    this.last = null; // point before the current one
  }

  // Adds the next point; `keep(x, y)` is called for each point that is kept.
  add(x, y, keep) {
    if (!this.pen) {
      keep(x, y);
      this.begin(x, y);
      return;
    }
    if (!this.reaches(x, y)) {
      keep(this.last.x, this.last.y);
      this.begin(this.last.x, this.last.y);
      this.reaches(x, y);
    }
    this.last = { x, y };
  }

  finish(keep) {
    if (this.last) keep(this.last.x, this.last.y);
  }

  begin(x, y) {
    this.pen = { x, y };
    this.last = null;
    this.far_px = 0;
    this.heading = null;
  }

  // Whether a straight line from the last point kept to this one passes all points between; narrows
  // the allowed directions.
  reaches(x, y) {
    const dx = x - this.pen.x, dy = y - this.pen.y;
    const away_px = Math.hypot(dx, dy);
    if (this.last && away_px < this.far_px - kThin_px) return false; // the line turned back
    this.far_px = Math.max(this.far_px, away_px);
    if (away_px <= kThin_px) return true;
    const spread = Math.asin(kThin_px / away_px);
    if (this.heading === null) {
      this.heading = Math.atan2(dy, dx);
      this.least = -spread; this.most = spread;
      return true;
    }
    let turn = Math.atan2(dy, dx) - this.heading;
    turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
    if (this.last && (turn < this.least || turn > this.most)) return false;
    this.least = Math.max(this.least, turn - spread);
    this.most = Math.min(this.most, turn + spread);
    return true;
  }
}
