// Draws the static content, starting with the background.

// Max number of landmarks in view that are drawn as single shapes with numbers.
const kShapesMost = 4000;

// Min scale [pixels per metre] at which landmarks outside rows show their ids.
const kScaleOfIds = 50;

// Opacity of hedges, so that landmarks within them remain visible.
const kHedgeFade = 0.6;

// Around a landmark the ground is shaded by its height as far as this: the trees of a row are joined.
const kHeightReach_m = 2.5;

class SceneBrush {
  constructor(context, view, ratio, painter) {
    Object.assign(this, { context, view, ratio, model: painter.model, theme: painter.theme, shown: painter.shown,
      dots: painter.dots });
  }

  paintBackground({ image, box: [x0, y0, x1, y1] }) {
    const { context, view } = this;
    const left = view.toScreenX(x0), top = view.toScreenY(y1);
    context.drawImage(image, left, top, view.toScreenX(x1) - left, view.toScreenY(y0) - top);
  }

  paintGround() {
    const { context, view, theme } = this;
    context.fillStyle = theme.colours.ground;
    context.fillRect(0, 0, view.width, view.height);
    const step = niceLength_m(90 / view.scale);
    const box = view.box();
    context.beginPath();
    for (let x = Math.ceil(box[0] / step) * step; x <= box[2]; x += step) {
      const sx = Math.round(view.toScreenX(x)) + 0.5;
      context.moveTo(sx, 0); context.lineTo(sx, view.height);
    }
    for (let y = Math.ceil(box[1] / step) * step; y <= box[3]; y += step) {
      const sy = Math.round(view.toScreenY(y)) + 0.5;
      context.moveTo(0, sy); context.lineTo(view.width, sy);
    }
    context.strokeStyle = theme.colours.grid;
    context.lineWidth = 1;
    context.stroke();
  }

  paintHeights() {
    const { context, view, model, theme } = this;
    if (!model.heights) return;
    const { low, high } = model.heights, { x, y, z, z_sd } = model.columns;
    for (const i of model.inBox(view.box(kHeightReach_m * view.scale)) || x.keys()) {
      if (!(z_sd[i] > 0)) continue;
      context.fillStyle = theme.colourOfHeight((z[i] - low) / Math.max(0.01, high - low));
      context.beginPath();
      context.arc(view.toScreenX(x[i]), view.toScreenY(y[i]), kHeightReach_m * view.scale, 0, 2 * Math.PI);
      context.fill();
    }
  }

  // Adds a line [x, y, x, y ...] in metres to the current path, without points beyond the edges or
  // within half a pixel of a straight line.
  addLine(line) {
    const { context, view } = this;
    const thinner = new LineThinner();
    let penX = NaN, penY = NaN, isBeyond = true;
    const draw = (sx, sy) => {
      const misses = Math.max(sx, penX) < 0 || Math.max(sy, penY) < 0 ||
        Math.min(sx, penX) > view.width || Math.min(sy, penY) > view.height;
      if (!misses && !Number.isNaN(penX)) {
        if (isBeyond) context.moveTo(penX, penY);
        context.lineTo(sx, sy);
      }
      isBeyond = misses || Number.isNaN(penX);
      penX = sx; penY = sy;
    };
    for (let k = 0; k + 1 < line.length; k += 2) thinner.add(view.toScreenX(line[k]), view.toScreenY(line[k + 1]), draw);
    thinner.finish(draw);
  }

  paintShades() {
    if (this.model.tiles) this.model.tiles.paintShades(this.context, this.view, this.theme, this.shown);
  }

  // Over a picture, so that it shows through.
  paintWays(opacity) {
    const { context, theme, view } = this;
    context.globalAlpha = opacity;
    context.lineCap = context.lineJoin = "round";
    context.strokeStyle = theme.colours.way;
    for (const way of this.model.ways) {
      context.beginPath();
      this.addLine(way.line);
      context.lineWidth = Math.max(1, way.width * view.scale);
      context.stroke();
    }
    context.lineCap = "butt";
    context.globalAlpha = 1;
  }

  paintRows() {
    const { context, theme } = this;
    context.strokeStyle = theme.colours.row;
    context.lineWidth = 1.5;
    for (const line of this.model.rowLines) { // one path per row: a single path with all rows is slow
      context.beginPath();
      this.addLine(line);
      context.stroke();
    }
  }

  paintPaths() {
    const { context, theme } = this;
    context.strokeStyle = theme.colours.path;
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    context.globalAlpha = 0.75;
    for (const path of this.model.paths) {
      context.beginPath();
      this.addLine(path);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  paintGaps() {
    const { context, view, theme } = this;
    const radius = Math.max(1.6, symbolRadius_px(view.scale));
    const box = view.box(10);
    for (const row of this.model.rows) {
      for (const [, x, y] of row.gaps) {
        if (x < box[0] || x > box[2] || y < box[1] || y > box[3]) continue;
        drawGap(context, view.toScreenX(x), view.toScreenY(y), radius, theme.colours.gap);
      }
    }
  }

  isShown(kind) { return this.shown[["trees", "objects", "unseen", "trunks"][kind]]; }

  // Draws hedges and walls to scale, also those that are only partly in view.
  paintHedges() {
    const { context, view, model, theme } = this;
    context.lineCap = "round";
    for (const { i, ax, ay, bx, by } of model.hedges) {
      if (!this.isShown(model.look(i))) continue;
      context.beginPath();
      this.addLine([ax, ay, bx, by]);
      context.strokeStyle = theme.colourOfKind(model.look(i));
      context.lineWidth = Math.max(2, model.columns.width[i] * view.scale);
      context.globalAlpha = kHedgeFade;
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  // Draws the landmarks and returns the indices in view, or null if there are too many for labels.
  paintLandmarks() {
    const { view, model } = this;
    this.paintHedges();
    const found = model.inBox(view.box(30));
    if ((found || model.columns.id).length > kShapesMost) {
      this.paintDots();
      return null;
    }
    const inView = found || Array.from(model.columns.id.keys());
    const radius = symbolRadius_px(view.scale);
    for (const i of inView) {
      const look = model.look(i);
      if (!this.isShown(look) || model.isHedge(i)) continue;
      drawLandmark(this.context, look, look === kUnseen ? 2 : model.certainty(i), view.toScreenX(model.columns.x[i]),
        view.toScreenY(model.columns.y[i]), Math.max(radius, model.columns.width[i] * view.scale / 2),
        this.theme.colourOfKind(look));
    }
    return inView;
  }

  paintDots() {
    const groups = this.model.styles.map((indices, style) => ({ indices, look: Math.floor(style / 3),
      colour: this.theme.colourOfKind(Math.floor(style / 3)), fade: kFadeOfCertainty[style % 3] }));
    this.dots.paint(this.context, this.view, this.ratio, this.model.columns.x, this.model.columns.y,
      groups.filter((group) => this.isShown(group.look)));
  }

  paintLabels(inView) {
    const { context, view, theme, model } = this;
    const placer = new LabelPlacer(context);
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
    for (const row of model.rows) {
      if (row.line.length < 4) continue;
      this.writeRowName(placer, row);
    }
    if (!inView) return;
    context.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const radius = symbolRadius_px(view.scale);
    const columns = model.columns;
    const stepOfRow = new Map(model.rows.map((row) => [row.number, labelStep(row.spacing * view.scale)]));
    // Numbers are placed across the row, where the next tree does not stand.
    const besideOfRow = new Map(model.rows.map((row) => [row.number, isUpright(row.line)]));
    for (const i of inView) {
      if (!this.isShown(model.look(i))) continue;
      const position = columns.position[i];
      const step = position > 0 ? stepOfRow.get(columns.row[i]) || 1 : 1;
      if (position > 0 && position % step !== 0) continue;
      if (position === 0 && view.scale < kScaleOfIds) continue;
      const text = position > 0 ? String(position) : `#${columns.id[i]}`;
      const off = Math.max(radius, columns.width[i] * view.scale / 2) + 5;
      const isBeside = besideOfRow.get(columns.row[i]) !== false;
      placer.write(text, view.toScreenX(columns.x[i]) + (isBeside ? off + context.measureText(text).width / 2 : 0),
        view.toScreenY(columns.y[i]) + (isBeside ? 0 : off + 5),
        position > 0 ? theme.colours.text : theme.colours.soft, theme.colours.ground);
    }
  }

  // Writes the row's name before its first tree, in line with the row; it stays in view while the
  // row does.
  writeRowName(placer, row) {
    const { view, theme } = this;
    const ax = view.toScreenX(row.line[0]), ay = view.toScreenY(row.line[1]);
    const bx = view.toScreenX(row.line[2]), by = view.toScreenY(row.line[3]);
    const length = Math.hypot(bx - ax, by - ay) || 1;
    const sx = ax - (bx - ax) / length * 24, sy = ay - (by - ay) / length * 24;
    if (sx < -20 || sy < -20 || sx > view.width + 20 || sy > view.height + 20) return;
    placer.write(this.model.rowName(row.number), sx, sy, theme.colours.ground, "", theme.colours.tree);
  }
}
