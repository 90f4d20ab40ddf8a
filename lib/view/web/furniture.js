// Scale bar and north arrow.

// The largest value of 1, 2, 5 times a power of ten that is at most `most_m`.
function niceLength_m(most_m) {
  const power = 10 ** Math.floor(Math.log10(most_m));
  return [5, 2, 1].map((digit) => digit * power).find((length) => length <= most_m * 1.000001) || power;
}

function lengthText(length_m) {
  if (length_m >= 1000) return `${length_m / 1000} km`;
  if (length_m >= 1) return `${length_m} m`;
  if (length_m >= 0.01) return `${Math.round(length_m * 100)} cm`;
  return `${Math.round(length_m * 1000)} mm`;
}

function showScale(view) {
  const length_m = niceLength_m(120 / view.scale);
  document.getElementById("scale-text").textContent = lengthText(length_m);
  document.getElementById("scale-bar").style.width = `${length_m * view.scale}px`;
}

// The scale bar as part of the map, which paper shows in another size than the screen.
function paintScale(context, view, theme) {
  const length_m = niceLength_m(120 / view.scale), x = view.width - 80 - length_m * view.scale, y = view.height - 24;
  context.strokeStyle = context.fillStyle = theme.colours.text;
  context.lineWidth = 2;
  context.strokeRect(x, y, length_m * view.scale, 0);
  context.font = "14px system-ui, sans-serif";
  context.textAlign = "left";
  context.fillText(lengthText(length_m), x, y - 10);
}

// With a georeference the arrow points north; otherwise the text says that north is unknown.
function showNorth(georeference) {
  const box = document.getElementById("north");
  const kSvg = "http://www.w3.org/2000/svg";
  const make = (name, attributes, text) => {
    const element = document.createElementNS(kSvg, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text) element.textContent = text;
    return element;
  };
  const svg = make("svg", { viewBox: "-15 -22 30 44" });
  const letter = { "text-anchor": "middle", "font-size": 11, "font-weight": 650, fill: "var(--text)" };
  if (georeference) {
    const turned = make("g", { transform: `rotate(${georeference.yaw_rad * 180 / Math.PI})` });
    turned.append(make("path", { d: "M0,-9 L6,14 L0,10 Z", fill: "var(--text)" }),
      make("path", { d: "M0,-9 L-6,14 L0,10 Z", fill: "var(--soft)" }), make("text", { ...letter, y: -12 }, "N"));
    svg.append(turned);
    box.title = "North";
  } else {
    const line = { d: "M-7,-9 L-7,12 L12,12 M-10,-5 L-7,-10 L-4,-5 M8,9 L13,12 L8,15", fill: "none",
      stroke: "var(--text)", "stroke-width": 1.6 };
    svg.append(make("path", line), make("text", { ...letter, x: -7, y: -13 }, "y"),
      make("text", { ...letter, x: 11, y: 5 }, "x"));
    box.title = "Axes of the map; north is unknown, because the map is not georeferenced";
  }
  box.setAttribute("aria-label", box.title);
  box.replaceChildren(svg);
}
