// Image of the static content, kept with a margin around the view; moving the view shows another
// part of it.

const kSceneMargin = 0.3; // fraction of the view's width and height, on each side

class Scene {
  // `draw(context, view, ratio)` draws everything for a view.
  constructor(draw) {
    this.draw = draw;
    this.canvas = document.createElement("canvas");
    this.view = new Viewport();
    this.key = null;
  }

  // Shows the image on `target`; `key` identifies the content it was drawn from.
  paint(target, view, ratio, key) {
    const fits = Math.abs(view.x - this.view.x) * view.scale <= kSceneMargin * view.width &&
      Math.abs(view.y - this.view.y) * view.scale <= kSceneMargin * view.height;
    if (!fits || key !== this.key || view.scale !== this.view.scale) this.make(view, ratio, key);
    const whole = (length) => Math.round(length * ratio) / ratio; // whole device pixels, to avoid blur
    const left = whole((this.view.x - view.x) * view.scale - (this.view.width - view.width) / 2);
    const top = whole((view.y - this.view.y) * view.scale - (this.view.height - view.height) / 2);
    target.drawImage(this.canvas, left, top, this.view.width, this.view.height);
  }

  make(view, ratio, key) {
    const even = (length) => 2 * Math.round(length * (0.5 + kSceneMargin));
    Object.assign(this.view, { x: view.x, y: view.y, scale: view.scale, width: even(view.width), height: even(view.height) });
    this.key = key;
    this.canvas.width = Math.round(this.view.width * ratio);
    this.canvas.height = Math.round(this.view.height * ratio);
    const context = this.canvas.getContext("2d", { alpha: false });
    context.setTransform(this.canvas.width / this.view.width, 0, 0, this.canvas.height / this.view.height, 0, 0);
    this.draw(context, this.view, ratio);
  }
}
