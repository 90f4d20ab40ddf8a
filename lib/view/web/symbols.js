// Symbols of landmarks: of fixed size while the trunk itself would be too small to see.

const kSymbol_m = 0.28, kSymbolLeast_px = 1, kSymbolMost_px = 6;
const kFadeOfCertainty = [1, 0.5, 0.3];

function symbolRadius_px(scale) {
  return Math.min(kSymbolMost_px, Math.max(kSymbolLeast_px, kSymbol_m * scale));
}

// Draws one landmark on the canvas. `radius` [px]: of the symbol or, if larger, of the trunk.
function drawLandmark(context, label, certainty, sx, sy, radius, colour) {
  context.beginPath();
  if (label === kObject) context.rect(sx - radius * 0.89, sy - radius * 0.89, radius * 1.78, radius * 1.78);
  else context.arc(sx, sy, radius, 0, 2 * Math.PI);
  context.globalAlpha = kFadeOfCertainty[certainty];
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 1;
  if (certainty > 0 || label === kUnseen) {
    context.lineWidth = 1.3;
    context.strokeStyle = colour;
    context.stroke();
  }
}

// Draws a gap: a position of a row without a tree.
function drawGap(context, sx, sy, radius, colour) {
  context.beginPath();
  context.arc(sx, sy, radius, 0, 2 * Math.PI);
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.setLineDash([Math.max(1.5, radius * 0.7), Math.max(1.2, radius * 0.5)]);
  context.stroke();
  context.setLineDash([]);
}
