// A live drive: applies the events of the viewer to the map.

class Live {
  constructor(app) {
    this.app = app;
    this.pose = null;
    this.scan = [];
    this.isMoved = false; // moved by the user; until then the view follows the growing map
    this.panels = new LivePanels(byId("live"));
    app.painter.overlays.push((...all) => this.paint(...all));
    for (const name of ["pointerdown", "wheel", "keydown"]) {
      app.canvas.addEventListener(name, () => { this.isMoved = true; });
    }
    byId("fit").addEventListener("click", () => { this.isMoved = false; });
    this.listen();
  }

  listen() {
    const source = new EventSource("api/stream");
    source.onmessage = (message) => this.take(JSON.parse(message.data));
    watchConnection(source);
  }

  take(event) {
    const { model } = this.app;
    if (event.kind === "hello") {
      model.replace({ landmarks: {}, paths: [[]] });
    } else if (event.kind === "map") {
      takeLandmarks(model, event);
      this.isListDue = true;
    } else if (event.kind === "rows") {
      model.setRows(event.rows, event.ways);
      this.isListDue = true;
    } else if (event.kind === "path") {
      model.paths[0] = event.is_new ? event.points : model.paths[0].concat(event.points);
      model.touch();
    } else if (event.kind === "pose") {
      this.pose = event;
    } else if (event.kind === "scan") {
      this.scan = event.points;
    } else if (event.kind === "look") {
      this.panels.showLook(event, this.app.theme);
    } else if (event.kind === "corrections") {
      this.app.takeCorrections(event);
      this.isListDue = true;
    } else if (event.kind === "status") {
      this.panels.showStatus(event);
    }
    this.showSoon();
  }

  // Redraws at most once per frame; updates lists and numbers of the panel once a second.
  showSoon() {
    const { app } = this;
    if (!this.isMoved && app.model.box) app.fit(); else app.redraw();
    if (!this.isListDue || this.isListWaiting) return;
    this.isListWaiting = true;
    setTimeout(() => {
      this.isListWaiting = this.isListDue = false;
      app.refreshLists();
    }, 1000);
  }

  paint(context, view, theme) {
    paintScan(context, view, theme, this.scan);
    if (this.pose) paintRobot(context, view, theme, this.pose);
  }
}

// Applies the landmark changes of an event.
function takeLandmarks(model, event) {
  const columns = event.landmarks;
  columns.id.forEach((id, k) => {
    const values = { length: 0, direction: 0 }; // omitted where zero
    for (const name of Object.keys(columns)) values[name] = columns[name][k];
    model.put(values);
  });
  event.removed.forEach((id) => model.remove(id));
}

function paintScan(context, view, theme, points) {
  context.fillStyle = theme.colours.scan;
  for (let k = 0; k + 1 < points.length; k += 2) {
    context.fillRect(view.toScreenX(points[k]) - 1, view.toScreenY(points[k + 1]) - 1, 2, 2);
  }
}

// Draws the robot, its direction, and its 95 % confidence ellipse.
function paintRobot(context, view, theme, pose) {
  const sx = view.toScreenX(pose.x), sy = view.toScreenY(pose.y);
  const [xx, xy, yy] = pose.covariance;
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  const axis = (variance) => 2.45 * Math.sqrt(Math.max(0, variance)) * view.scale;
  context.beginPath();
  context.ellipse(sx, sy, axis(mean + spread), axis(mean - spread), -0.5 * Math.atan2(2 * xy, xx - yy), 0, 2 * Math.PI);
  context.globalAlpha = 0.2;
  context.fillStyle = theme.colours.mark;
  context.fill();
  context.globalAlpha = 1;
  context.save();
  context.translate(sx, sy);
  context.rotate(-pose.yaw);
  context.beginPath();
  context.moveTo(11, 0); context.lineTo(-8, 7); context.lineTo(-4, 0); context.lineTo(-8, -7);
  context.closePath();
  context.fillStyle = theme.colours.mark;
  context.strokeStyle = theme.colours.ground;
  context.lineWidth = 1.5;
  context.fill();
  context.stroke();
  context.restore();
}
