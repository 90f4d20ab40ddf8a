// Content of the canvas: the scene, overlays that move, and the selection.

class Painter {
  constructor(canvas, model, view, theme) {
    this.canvas = canvas;
    this.model = model;
    this.view = view;
    this.theme = theme;
    this.shown = { trees: true, trunks: true, objects: true, unseen: true, rows: true, gaps: true, ways: true, paths: true,
      labels: true, background: true, robot: true, scan: true, heights: false };
    this.selected = -1;
    this.selectedGap = null;
    this.dots = new DotLayer();
    this.scene = new Scene((context, shownView, ratio) => this.paintScene(context, shownView, ratio));
    this.overlays = []; // functions (context, view, theme, shown), such as for the robot
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.view.width = this.canvas.clientWidth;
    this.view.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.view.width * ratio);
    this.canvas.height = Math.round(this.view.height * ratio);
  }

  paint() {
    const ratio = window.devicePixelRatio || 1;
    const key = [this.model.revision, this.theme.isDark, this.canvas.width, this.canvas.height,
      ...Object.values(this.shown)].join();
    const context = this.canvas.getContext("2d", { alpha: false });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.scene.paint(context, this.view, ratio, key);
    for (const overlay of this.overlays) overlay(context, this.view, this.theme, this.shown);
    this.paintSelection(context, this.view);
  }

  // Draws all static content onto a canvas.
  paintScene(context, view, ratio) {
    const brush = new SceneBrush(context, view, ratio, this);
    brush.paintGround();
    const background = this.shown.background && this.model.background;
    if (background) brush.paintBackground(background);
    if (this.shown.ways) brush.paintWays(background ? 0.35 : 1);
    if (this.shown.heights) brush.paintHeights();
    if (this.shown.rows) brush.paintRows();
    if (this.shown.paths) brush.paintPaths();
    if (this.shown.gaps) brush.paintGaps();
    brush.paintShades();
    const inView = brush.paintLandmarks();
    if (this.shown.labels) brush.paintLabels(inView);
  }

  paintSelection(context, view) {
    const { theme, model } = this;
    let x, y, radius = symbolRadius_px(view.scale);
    if (this.selected >= 0 && this.selected < model.count) {
      x = model.columns.x[this.selected]; y = model.columns.y[this.selected];
      radius = Math.max(radius, model.columns.width[this.selected] * view.scale / 2);
      this.paintEllipse(context, view, this.selected);
    } else if (this.selectedGap) {
      [, x, y] = this.selectedGap;
    } else {
      return;
    }
    context.beginPath();
    context.arc(view.toScreenX(x), view.toScreenY(y), radius + 5, 0, 2 * Math.PI);
    context.strokeStyle = theme.colours.mark;
    context.lineWidth = 2.5;
    context.stroke();
  }

  // 95 % confidence ellipse of the trunk axis: 2.45 standard errors in each direction.
  paintEllipse(context, view, i) {
    const { theme, model } = this;
    const a = 2.45 * model.columns.se_x[i] * view.scale, b = 2.45 * model.columns.se_y[i] * view.scale;
    if (!(a > 0 && b > 0)) return;
    context.beginPath();
    context.ellipse(view.toScreenX(model.columns.x[i]), view.toScreenY(model.columns.y[i]), a, b, 0, 0, 2 * Math.PI);
    context.strokeStyle = theme.colours.mark;
    context.lineWidth = 1;
    context.stroke();
  }
}
