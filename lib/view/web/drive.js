// A recorded drive, scan by scan: each step has the robot, its scan, its image and the map up to
// that time.

const kNewsWait_ms = 400; // period of requests while the log is still being mapped
const kDriveMargin_m = 6;

class Drive {
  constructor(app) {
    this.app = app;
    this.t_ms = []; this.x = []; this.y = []; this.yaw = []; this.covariance = [];
    this.changes = { step: [], removed: [], landmarks: {} };
    this.paths = [];
    this.seen = [0, 0, 0];
    this.step = 0;
    this.numApplied = 0; // number of changes applied to the model
    this.numbers = new Map(); // row and position by id, as in the finished map
    this.rows = []; this.ways = [];
    this.isDone = false; this.share = 0; this.problem = "";
    this.points = [];
    this.isMoved = false;
    this.panels = new LivePanels(byId("live"), "Picture");
    this.player = new Player(this, byId("player"));
    app.painter.overlays.push((...all) => this.paint(...all));
    for (const name of ["pointerdown", "wheel"]) app.canvas.addEventListener(name, () => { this.isMoved = true; });
    this.player.update();
    const source = new EventSource("api/stream"); // without events: it tells that the server is there
    watchConnection(source);
    source.addEventListener("open", () => { if (this.isDone) this.load(); }); // another server's drive reloads the page
    this.ask();
  }

  get numSteps() { return this.t_ms.length; }
  timeOf(step) { return step >= 0 && step < this.numSteps ? this.t_ms[step] / 1000 : 0; }

  // The last step at or before a time.
  stepAt(seconds) { return Math.max(0, firstAbove(this.t_ms, seconds * 1000 + 1e-6) - 1); }

  // Another server has a drive with other steps, so the page is reloaded.
  async fetch(address) {
    const answer = await fetch(`${address}&boot=${this.app.data.boot}`);
    if (answer.status === 409) location.reload();
    return answer;
  }

  async ask() {
    const [steps, changes, paths] = this.seen;
    try {
      const answer = await this.fetch(`api/drive?steps=${steps}&changes=${changes}&paths=${paths}`);
      if (!answer.ok) throw new Error(String(answer.status));
      this.take(await answer.json());
    } catch (error) {
      setTimeout(() => this.ask(), 2000);
      return;
    }
    if (!this.isDone && !this.problem) setTimeout(() => this.ask(), this.isMore ? 0 : kNewsWait_ms);
  }

  take(news) {
    const isFirst = this.numSteps === 0;
    this.t_ms.push(...news.t); this.x.push(...news.x); this.y.push(...news.y); this.yaw.push(...news.yaw);
    this.covariance.push(...news.covariance);
    this.changes.step.push(...news.changes.step);
    this.changes.removed.push(...news.changes.removed);
    for (const name of MapModel.columnNames) { // columns with default values are not sent
      const values = news.changes.landmarks[name] || new Array(news.changes.step.length).fill(0);
      (this.changes.landmarks[name] = this.changes.landmarks[name] || []).push(...values);
    }
    this.paths.push(...news.paths);
    this.seen = news.seen;
    this.isMore = news.is_more;
    this.share = news.share;
    this.problem = news.problem;
    if (news.is_done && !news.is_more && news.rows) this.finish(news);
    if (!this.isMoved) this.fit();
    if ((isFirst && this.numSteps > 0) || this.isDone) this.show(this.step, true);
    else this.player.update();
  }

  finish(news) {
    this.isDone = true;
    this.rows = news.rows;
    this.ways = news.ways;
    this.georeference = news.georeference || null;
    const { id, row, position } = this.changes.landmarks;
    (id || []).forEach((value, k) => { if (row[k] > 0) this.numbers.set(value, [row[k], position[k]]); });
    this.numApplied = -1;
    if (this.georeference) {
      this.app.model.georeference = this.georeference;
      showNorth(this.georeference);
    }
  }

  fit() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = 0; k < this.numSteps; ++k) {
      if (this.x[k] === null) continue;
      box[0] = Math.min(box[0], this.x[k] - kDriveMargin_m); box[1] = Math.min(box[1], this.y[k] - kDriveMargin_m);
      box[2] = Math.max(box[2], this.x[k] + kDriveMargin_m); box[3] = Math.max(box[3], this.y[k] + kDriveMargin_m);
    }
    if (box[0] <= box[2]) this.app.view.fit(box, this.app.insets());
  }

  show(step, isForced = false) {
    if (this.numSteps === 0) { this.player.update(); return; }
    const wanted = Math.min(this.numSteps - 1, Math.max(0, step));
    if (wanted === this.step && !isForced && this.isShown) return;
    this.isShown = true;
    this.step = wanted;
    this.showMap();
    this.player.update();
    this.load();
    this.app.redraw();
    this.showListsSoon();
  }

  // Shows the map as of this step's scan.
  showMap() {
    const { model } = this.app;
    const until = firstAbove(this.changes.step, this.step);
    const isLast = this.isDone && this.step === this.numSteps - 1;
    if (this.numApplied < 0 || until < this.numApplied || until - this.numApplied > 500) this.rebuild(until);
    else for (let k = this.numApplied; k < until; ++k) this.apply(k);
    this.numApplied = until;
    model.paths = [this.path()];
    model.setRows(isLast ? this.rows : [], isLast ? this.ways : []);
  }

  valuesOf(k) {
    const values = {};
    for (const [name, column] of Object.entries(this.changes.landmarks)) values[name] = column[k];
    const number = this.numbers.get(values.id);
    if (number) [values.row, values.position] = number;
    return values;
  }

  apply(k) {
    if (this.changes.removed[k]) this.app.model.remove(this.changes.landmarks.id[k]);
    else this.app.model.put(this.valuesOf(k));
  }

  rebuild(until) {
    const newest = new Map();
    for (let k = 0; k < until; ++k) newest.set(this.changes.landmarks.id[k], k);
    const landmarks = {};
    for (const name of MapModel.columnNames) landmarks[name] = [];
    for (const k of newest.values()) {
      if (this.changes.removed[k]) continue;
      const values = this.valuesOf(k);
      for (const name of MapModel.columnNames) landmarks[name].push(values[name] || 0);
    }
    this.app.model.replace({ landmarks, georeference: this.georeference });
  }

  // The path as estimated then: the last corrected path, and the poses since.
  path() {
    const at = firstAbove(this.paths.map((path) => path.step), this.step) - 1;
    const points = at >= 0 ? this.paths[at].points.slice() : [];
    for (let k = at >= 0 ? this.paths[at].step + 1 : 0; k <= this.step; ++k) {
      if (this.x[k] !== null) points.push(this.x[k], this.y[k]);
    }
    return points;
  }

  // Loads scan and image of the step shown; during a request only the latest further one is
  // remembered.
  async load() {
    if (this.isLoading) { this.isLoadDue = true; return; }
    this.isLoading = true;
    const step = this.step;
    try {
      const answer = await this.fetch(`api/step?at=${step}`);
      if (answer.ok) {
        const reply = await answer.json();
        this.points = reply.points || [];
        this.pointsStep = reply.step;
        if (reply.look) this.panels.showLook(reply.look, this.app.theme);
        this.app.redraw();
      }
    } catch (error) {
      // No server: the banner says so. The step is loaded when it is back.
    }
    this.isLoading = false;
    if (this.isLoadDue) { this.isLoadDue = false; this.load(); }
  }

  showListsSoon() {
    if (this.isListWaiting) return;
    this.isListWaiting = true;
    setTimeout(() => {
      this.isListWaiting = false;
      showSummary(this.app.model, this.app.data);
      showRows(this.app.model, (row) => this.app.showRow(row));
      this.app.refreshDetails();
    }, this.isDone ? 100 : 500);
  }

  paint(context, view, theme, shown) {
    if (this.pointsStep === this.step) paintScan(context, view, theme, this.points);
    const k = this.step;
    if (k >= this.numSteps || this.x[k] === null) return;
    paintRobot(context, view, theme, { x: this.x[k], y: this.y[k], yaw: this.yaw[k],
      covariance: this.covariance.slice(3 * k, 3 * k + 3) });
  }
}

// Number of elements of an increasing list that are at most `value`.
function firstAbove(list, value) {
  let low = 0, high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle + 1; else high = middle;
  }
  return low;
}
