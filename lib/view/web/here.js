// On foot: where this device is, how far the next tree is, and a ruler.

// Metres from a latitude and longitude to another, east and north (WGS 84, for some kilometres).
function metresBetween(from, to) {
  const kEquator_m = 6378137, kSquare = 0.00669437999014, sine = Math.sin(from[0] * Math.PI / 180);
  const across_m = kEquator_m / Math.sqrt(1 - kSquare * sine * sine);
  const along_m = across_m * (1 - kSquare) / (1 - kSquare * sine * sine);
  const turn = Math.PI / 180;
  return [(to[1] - from[1]) * turn * across_m * Math.cos(from[0] * turn), (to[0] - from[0]) * turn * along_m];
}

// Place in the map of a latitude and longitude, by a landmark that has both; null without one.
function placeOf(model, latitude, longitude) {
  const { columns, georeference } = model;
  const i = columns.latitude ? columns.latitude.findIndex((value) => value) : -1;
  if (!georeference || i < 0) return null;
  const [east, north] = metresBetween([columns.latitude[i], columns.longitude[i]], [latitude, longitude]);
  const cosine = Math.cos(georeference.yaw_rad), sine = Math.sin(georeference.yaw_rad);
  return [columns.x[i] + cosine * east + sine * north, columns.y[i] - sine * east + cosine * north];
}

const kWinds = ["east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east"];

// `yaw_rad`: of the map's x axis, from east.
function directionWord(dx, dy, yaw_rad) {
  const eighths = Math.round((Math.atan2(dy, dx) + yaw_rad) / (Math.PI / 4));
  return kWinds[((eighths % 8) + 8) % 8];
}

class Here {
  constructor(app) {
    this.app = app;
    this.place = null;
    this.ruler = null; // points of the line that is measured; null: switched off
    app.painter.overlays.push((context, view, theme) => this.paint(context, view, theme));
    byId("here").hidden = !app.model.georeference || !navigator.geolocation;
    byId("here").addEventListener("click", () => this.watch());
    byId("ruler").addEventListener("click", () => this.setRuler(this.ruler === null));
  }

  watch() {
    if (this.watching !== undefined) { this.show(); return; }
    byId("found").textContent = "Waiting for this device's position …";
    this.watching = navigator.geolocation.watchPosition(
      ({ coords }) => this.take(coords.latitude, coords.longitude, coords.accuracy),
      (error) => {
        navigator.geolocation.clearWatch(this.watching);
        this.watching = undefined;
        byId("found").textContent = `No position: ${error.message || "this device refuses"}.`;
      }, { enableHighAccuracy: true });
  }

  take(latitude, longitude, accuracy_m) {
    const isFirst = this.place === null;
    this.place = placeOf(this.app.model, latitude, longitude);
    this.accuracy_m = accuracy_m;
    if (isFirst && this.place) this.app.goTo(...this.place);
    this.show();
  }

  // The selected tree, else the nearest one; -1: none.
  target() {
    const { app } = this, kReach_m = 100;
    const selected = app.selectedId === null ? -1 : app.model.withId(app.selectedId);
    return selected >= 0 ? selected : app.model.nearest(...this.place, kReach_m);
  }

  show() {
    if (!this.place) return;
    const { model } = this.app, i = this.target();
    if (i < 0) { byId("found").textContent = "You are here; no tree is within 100 m."; this.app.redraw(); return; }
    const dx = model.columns.x[i] - this.place[0], dy = model.columns.y[i] - this.place[1];
    const name = model.columns.position[i] > 0
      ? `Row ${model.rowName(model.columns.row[i])}, tree ${model.columns.position[i]}` : `#${model.columns.id[i]}`;
    byId("found").textContent = `${name}: ${Math.hypot(dx, dy).toFixed(1)} m to the ` +
      `${directionWord(dx, dy, model.georeference.yaw_rad)} (position known to ${Math.round(this.accuracy_m)} m).`;
    this.app.redraw();
  }

  setRuler(isOn) {
    this.ruler = isOn ? [] : null;
    byId("ruler").setAttribute("aria-pressed", String(isOn));
    byId("found").textContent = isOn ? "Click two or more points to measure." : "";
    this.app.redraw();
  }

  // Returns whether the ruler took the click.
  takeClick(x, y) {
    if (this.ruler === null) return false;
    this.ruler.push([x, y]);
    const steps = this.ruler.slice(1).map((p, k) => Math.hypot(p[0] - this.ruler[k][0], p[1] - this.ruler[k][1]));
    const whole = steps.reduce((sum, step) => sum + step, 0);
    if (steps.length > 0) {
      byId("found").textContent = `${whole.toFixed(2)} m` + (steps.length > 1 ? `, the last ${steps[steps.length - 1].toFixed(2)} m` : "");
    }
    this.app.redraw();
    return true;
  }

  paint(context, view, theme) {
    const line = (points, dash) => {
      context.beginPath();
      points.forEach(([x, y]) => context.lineTo(view.toScreenX(x), view.toScreenY(y)));
      context.setLineDash(dash);
      context.strokeStyle = theme.colours.mark;
      context.lineWidth = 2;
      context.stroke();
      context.setLineDash([]);
    };
    const dot = ([x, y], radius_px, opacity) => {
      context.beginPath();
      context.arc(view.toScreenX(x), view.toScreenY(y), radius_px, 0, 2 * Math.PI);
      context.globalAlpha = opacity;
      context.fillStyle = theme.colours.mark;
      context.fill();
      context.globalAlpha = 1;
    };
    if (this.ruler) { line(this.ruler, []); this.ruler.forEach((point) => dot(point, 4, 1)); }
    if (!this.place) return;
    const { model } = this.app, i = this.target();
    if (i >= 0) line([this.place, [model.columns.x[i], model.columns.y[i]]], [6, 5]);
    dot(this.place, this.accuracy_m * view.scale, 0.15);
    dot(this.place, 7, 1);
  }
}
