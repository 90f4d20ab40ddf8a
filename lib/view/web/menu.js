// Legend with a switch for each layer, list of rows, notes.

const kLayers = [
  ["trees", "Trees", (c, t) => drawLandmark(c, kTree, 0, 13, 9, 6, t.colours.tree)],
  ["trunks", "Other trunks, in no row", (c, t) => drawLandmark(c, kTrunk, 0, 13, 9, 6, t.colours.trunk)],
  ["objects", "Objects (not trees)", (c, t) => drawLandmark(c, kObject, 0, 13, 9, 6, t.colours.object)],
  ["unseen", "Not classified yet", (c, t) => drawLandmark(c, kUnseen, 2, 13, 9, 6, t.colours.unseen)],
  ["gaps", "Gaps in rows", (c, t) => drawGap(c, 13, 9, 6, t.colours.gap)],
  ["rows", "Rows", (c, t) => drawKeyLine(c, t.colours.row, 2)],
  ["ways", "Aisles and headland paths, with free width", (c, t) => drawKeyLine(c, t.colours.way, 9)],
  ["paths", "The robot's path", (c, t) => drawKeyLine(c, t.colours.path, 2)],
  ["labels", "Numbers", (c, t) => drawKeyText(c, t.colours.text)],
];

function drawKeyLine(context, colour, width) {
  context.beginPath();
  context.moveTo(2, 9); context.lineTo(24, 9);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
}

function drawKeyText(context, colour) {
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillStyle = colour;
  context.fillText("14", 13, 9);
}

function keyPicture(draw, theme) {
  const ratio = window.devicePixelRatio || 1;
  const canvas = element("canvas", { width: 26 * ratio, height: 18 * ratio });
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  draw(context, theme);
  return canvas;
}

// From the lowest ground to the highest.
function drawKeyHeights(context, theme) {
  for (let x = 2; x < 24; x += 2) {
    context.fillStyle = theme.colourOfHeight((x - 2) / 20);
    context.fillRect(x, 3, 2, 12);
  }
}

// The layers that this map has.
function layersOf({ heights, hasBackground }) {
  const layers = kLayers.slice();
  if (hasBackground) layers.push(["background", "The picture beneath", (c, t) => drawKeyLine(c, t.colours.gap, 9)]);
  if (heights) {
    const words = `Height of the ground, ${heights.low.toFixed(1)} to ${heights.high.toFixed(1)}\u00a0m`;
    layers.push(["heights", words, drawKeyHeights]);
  }
  return layers;
}

function showLegend(theme, shown, model, changed) {
  const lines = layersOf(model).map(([layer, words, draw]) => {
    const box = element("input", { type: "checkbox", checked: shown[layer] });
    box.dataset.layer = layer;
    box.addEventListener("change", () => { shown[layer] = box.checked; changed(); });
    return element("label", {}, keyPicture(draw, theme), element("span", { textContent: words }), box);
  });
  const sureness = keyPicture((c, t) => {
    [0, 1, 2].forEach((certainty) => drawLandmark(c, kTree, certainty, 4 + 9 * certainty, 9, 3.6, t.colours.tree));
  }, theme);
  lines.push(element("label", { className: "key" }, sureness,
    element("span", { textContent: "sure (90 %), likely (70 %), unsure" })));
  byId("legend").replaceChildren(...lines);
}

// Why rows begin with another number than most.
function lateRows(model) {
  const first = Math.min(...model.rows.map((row) => row.first));
  const late = model.rows.filter((row) => row.first > first);
  if (late.length === 0) return [];
  const names = late.map((row) => `${model.rowName(row.number)} (begins at ${row.first})`).join(", ");
  return [element("p", { textContent: `Rows whose first places are empty: ${names}. Their numbers are counted from where ` +
    "the rows around them, or the plan, begin." })];
}

// `show(row)` moves the view to a row; `rename(row)`, if editing is possible, renames it.
function showRows(model, show, rename = null) {
  const head = element("tr", {}, ...["Row", "Trees", "Gaps", "Spacing", "Trunk"].map((words) =>
    element("th", { textContent: words })));
  const widths = new Map();
  for (let i = 0; i < model.count; ++i) {
    const row = model.columns.row[i];
    if (model.columns.label[i] !== kTree) continue;
    if (!widths.has(row)) widths.set(row, []);
    widths.get(row).push(model.columns.width[i]);
  }
  const lines = model.rows.map((row) => {
    const button = element("button", { type: "button", textContent: `Row ${model.rowName(row.number)}` });
    button.addEventListener("click", () => show(row));
    const pen = element("button", { type: "button", className: "rename", title: "Name this row", textContent: "✎" });
    if (rename) pen.addEventListener("click", () => rename(row));
    const trunk = widths.get(row.number) || [];
    // Rows of a large map come with their numbers, as their trees are not all loaded.
    const mean = row.trunk !== undefined ? row.trunk
      : trunk.length > 0 ? trunk.reduce((sum, width) => sum + width, 0) / trunk.length : 0;
    const numTrees = row.trees === undefined ? trunk.length : row.trees;
    return element("tr", {}, element("td", {}, button, ...(rename ? [" ", pen] : [])), element("td", { textContent: wholeNumber(numTrees) }),
      element("td", { textContent: wholeNumber(MapModel.numGapsOf(row)) }),
      element("td", { textContent: `${row.spacing.toFixed(2)} m` }),
      element("td", { textContent: mean > 0 ? `${(100 * mean).toFixed(1)} cm` : "" }));
  });
  byId("rows").replaceChildren(element("table", {}, head, ...lines), ...lateRows(model));
  byId("rows-box").hidden = model.rows.length === 0;
}

function showSummary(model, data) {
  const counted = (number, one, many) => (number === 0 ? [] : [`${wholeNumber(number)}\u00a0${number === 1 ? one : many}`]);
  const trunks = model.hasTrees ? ["other trunk", "other trunks"] : ["trunk", "trunks"];
  const parts = [...counted(model.numberOf(kTree), "tree in a row", "trees in rows"),
    ...counted(model.numberOf(kTrunk), ...trunks), ...counted(model.numberOf(kObject), "object", "objects"),
    ...counted(model.rows.length, "row", "rows"), ...counted(model.numGaps, "gap", "gaps")];
  byId("summary").textContent = parts.join(" · ") || "The map is empty";
  byId("title").textContent = data.title || "Orchard map";
  byId("notes").replaceChildren(...(data.warnings || []).map((words) => element("li", { textContent: words })));
  byId("notes-box").hidden = (data.warnings || []).length === 0;
  const made = [`Orchard Mapper ${data.version || ""}`.trim()];
  // The clock of a log may have any epoch: only a plausible date is shown.
  if (data.last_utime > 946684800e6) made.push(new Date(data.last_utime / 1000).toISOString().slice(0, 16).replace("T", " ") + " UTC");
  byId("about").textContent = made.join(" · ");
}
