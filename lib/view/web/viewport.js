// The part of the map shown by the canvas: a centre in metres and a scale, with north (or y) up.

const kScaleLeast = 0.02, kScaleMost = 4000; // pixels per metre

class Viewport {
  constructor() {
    this.x = 0; this.y = 0; this.scale = 20;
    this.width = 1; this.height = 1;
  }

  toScreenX(x) { return (x - this.x) * this.scale + this.width / 2; }
  toScreenY(y) { return this.height / 2 - (y - this.y) * this.scale; }
  toMapX(sx) { return this.x + (sx - this.width / 2) / this.scale; }
  toMapY(sy) { return this.y - (sy - this.height / 2) / this.scale; }

  box(margin_px = 0) {
    return [this.toMapX(-margin_px), this.toMapY(this.height + margin_px),
      this.toMapX(this.width + margin_px), this.toMapY(-margin_px)];
  }

  moveBy(dx_px, dy_px) {
    this.x -= dx_px / this.scale;
    this.y += dy_px / this.scale;
  }

  // Zooms; the point under (sx, sy) stays fixed.
  zoomAt(sx, sy, factor) {
    const x = this.toMapX(sx), y = this.toMapY(sy);
    this.scale = Math.min(kScaleMost, Math.max(kScaleLeast, this.scale * factor));
    this.x = x - (sx - this.width / 2) / this.scale;
    this.y = y + (sy - this.height / 2) / this.scale;
  }

  // Shows a whole box in the area not covered by panels: insets {left, top, right, bottom} [px].
  fit(box, insets) {
    const wide_px = Math.max(60, this.width - insets.left - insets.right);
    const high_px = Math.max(60, this.height - insets.top - insets.bottom);
    const wide_m = Math.max(2, box[2] - box[0]), high_m = Math.max(2, box[3] - box[1]);
    this.scale = Math.min(kScaleMost, Math.max(kScaleLeast, Math.min(wide_px / wide_m, high_px / high_m) * 0.94));
    this.centreOn((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, insets);
  }

  centreOn(x, y, insets) {
    this.x = x - (insets.left - insets.right) / 2 / this.scale;
    this.y = y + (insets.top - insets.bottom) / 2 / this.scale;
  }
}
