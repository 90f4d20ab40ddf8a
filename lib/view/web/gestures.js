// Converts touch, mouse and key events to movements of the view.

const kClickMost_px = 6;

class Gestures {
  // `changed()` is called after each movement; `clicked(sx, sy, isKey)` after a click without
  // movement, or for the middle of the view by Enter.
  constructor(canvas, view, changed, clicked) {
    this.canvas = canvas;
    this.view = view;
    this.changed = changed;
    this.clicked = clicked;
    this.pointers = new Map();
    this.travel_px = 0;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => this.up(event, name === "pointerup"));
    }
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  down(event) {
    if (this.pointers.size === 0) this.travel_px = 0;
    this.pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    try { this.canvas.setPointerCapture(event.pointerId); } catch { /* the pointer has gone already */ }
    this.canvas.classList.add("dragging");
  }

  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const others = [...this.pointers.values()].filter((other) => other !== pointer);
    const dx = event.offsetX - pointer.x, dy = event.offsetY - pointer.y;
    this.travel_px += Math.hypot(dx, dy);
    if (others.length === 0) {
      if (this.travel_px > kClickMost_px) this.view.moveBy(dx, dy);
    } else {
      const other = others[0];
      const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
      const after = Math.hypot(event.offsetX - other.x, event.offsetY - other.y);
      this.view.moveBy(dx / 2, dy / 2);
      if (before > 0) {
        this.view.zoomAt((event.offsetX + other.x) / 2, (event.offsetY + other.y) / 2, after / before);
      }
    }
    pointer.x = event.offsetX;
    pointer.y = event.offsetY;
    this.changed();
  }

  up(event, isClick) {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) return;
    this.canvas.classList.remove("dragging");
    if (isClick && this.travel_px <= kClickMost_px) this.clicked(event.offsetX, event.offsetY);
  }

  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.view.zoomAt(event.offsetX, event.offsetY, Math.exp(-event.deltaY * lines * 0.0016));
    this.changed();
  }

  key(event) {
    const step = 80;
    const moves = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (event.key === "Enter") this.clicked(this.view.width / 2, this.view.height / 2, true);
    else if (moves[event.key]) this.view.moveBy(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.view.zoomAt(this.view.width / 2, this.view.height / 2, 1.4);
    else if (event.key === "-") this.view.zoomAt(this.view.width / 2, this.view.height / 2, 1 / 1.4);
    else return;
    event.preventDefault();
    this.changed();
  }
}
