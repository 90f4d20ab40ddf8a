// Draws many landmarks pixel by pixel: a hundred thousand shapes would take a canvas a second.

class DotLayer {
  constructor() {
    this.canvas = document.createElement("canvas");
  }

  // Draws `groups` [{indices, colour "#rrggbb", fade 0 ... 1}] at positions x, y [m], as seen by
  // `view`, onto `target`, with the size of a symbol.
  paint(target, view, ratio, x, y, groups) {
    const wide = Math.round(view.width * ratio), high = Math.round(view.height * ratio);
    this.canvas.width = wide;
    this.canvas.height = high;
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(wide, high);
    const pixels = new Uint32Array(image.data.buffer);
    const size = Math.max(1, Math.round(2 * symbolRadius_px(view.scale) * ratio));
    const scale = view.scale * ratio;
    const toX = wide / 2 - view.x * scale - size / 2, toY = high / 2 + view.y * scale - size / 2;
    const cut = size >= 4 ? 1 : 0; // corners are omitted for a round shape
    for (const { indices, colour, fade } of groups) {
      const value = pixelValue(colour, fade);
      for (const i of indices) {
        const left = Math.round(x[i] * scale + toX), top = Math.round(toY - y[i] * scale);
        if (left < 0 || top < 0 || left + size > wide || top + size > high) continue;
        for (let row = 0; row < size; ++row) {
          const less = row === 0 || row === size - 1 ? cut : 0;
          const begin = (top + row) * wide + left;
          pixels.fill(value, begin + less, begin + size - less);
        }
      }
    }
    context.putImageData(image, 0, 0);
    target.drawImage(this.canvas, 0, 0, view.width, view.height);
  }
}

// Pixel format of an image: alpha, blue, green, red from the highest byte down.
function pixelValue(colour, fade) {
  const rgb = parseInt(colour.slice(1), 16);
  const alpha = Math.round(255 * fade);
  return ((alpha << 24) | ((rgb & 255) << 16) | (rgb & 0xff00) | (rgb >> 16)) >>> 0;
}
