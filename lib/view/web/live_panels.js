// Panels of the live page: the camera image with the detections, and the state of each process.

const kHistory = 60; // length of a plot [s]; STATUS is sent once a second

class LivePanels {
  constructor(box, title = "Live") {
    this.box = box;
    box.hidden = false;
    this.picture = element("canvas", { id: "look", hidden: true });
    this.confidences = element("div", { id: "confidences" });
    this.processes = element("div", { id: "processes" });
    this.disk = element("small", {});
    const line = element("div", { className: "live-line" }, element("strong", { textContent: title }), this.disk);
    box.replaceChildren(line, this.picture, this.confidences, this.processes);
    this.history = new Map(); // by process: {rates, latencies, lost}
  }

  showLook(look, theme) {
    if (this.isLoading) return; // the next one follows soon
    this.isLoading = true;
    const image = new Image();
    image.onload = () => {
      this.isLoading = false;
      const ratio = 2;
      const width = look.width || image.naturalWidth, height = look.height || image.naturalHeight;
      this.picture.width = width * ratio;
      this.picture.height = height * ratio;
      this.picture.hidden = false;
      const context = this.picture.getContext("2d");
      context.scale(ratio, ratio);
      context.drawImage(image, 0, 0, width, height);
      look.trunks.forEach((trunk, k) => drawLook(context, trunk, k + 1, theme));
      this.confidences.replaceChildren(...(look.trunks.length > 0 ? [lookTable(look.trunks, theme)] : []));
    };
    image.onerror = () => { this.isLoading = false; };
    image.src = `api/picture?${look.picture}`;
  }

  showStatus(status) {
    if (status.disk_bytes !== undefined) this.disk.textContent = `disk: ${(status.disk_bytes / 1e9).toFixed(1)} GB left`;
    this.processes.replaceChildren(...status.processes.map((process) => this.processLine(process)));
  }

  processLine(process) {
    const key = `${process.host} ${process.name}`;
    const past = this.history.get(key) || { rates: [], latencies: [] };
    this.history.set(key, past);
    for (const [list, value] of [[past.rates, process.input_hz], [past.latencies, 1000 * process.latency_max_s]]) {
      list.push(value);
      if (list.length > kHistory) list.shift();
    }
    const refused = process.num_bad > 0 ? ` · refused ${wholeNumber(process.num_bad)}` : "";
    const late = process.num_late > 0 ? ` · late ${wholeNumber(process.num_late)}` : "";
    const counts = `in ${process.input_hz.toFixed(1)} Hz · ${(1000 * process.latency_max_s).toFixed(1)} ms · ` +
      `lost ${wholeNumber(process.num_lost)}${refused}${late}`;
    const words = process.text ? [element("p", { textContent: process.text })] : [];
    return element("div", { className: "process" },
      element("div", { className: "live-line" },
        element("span", { textContent: process.name.replace(/^orchard-/, "") }),
        element("span", { className: `state ${process.state}`, textContent: process.state }),
        sparkline(past.rates, "rate of inputs"), sparkline(past.latencies, "latency")),
      element("small", { textContent: counts }), ...words);
  }
}

// Draws the last minute as a small plot with a range from 0.
function sparkline(values, title) {
  const kSvg = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(kSvg, "svg");
  svg.setAttribute("viewBox", `0 0 ${kHistory} 16`);
  svg.setAttribute("class", "sparkline");
  const words = document.createElementNS(kSvg, "title");
  words.textContent = `${title}, last minute, up to ${Math.max(...values).toFixed(1)}`;
  const line = document.createElementNS(kSvg, "polyline");
  const most = Math.max(...values, 1e-9);
  line.setAttribute("points", values.map((value, k) =>
    `${kHistory - values.length + k},${(15 - 14 * value / most).toFixed(1)}`).join(" "));
  svg.append(words, line);
  return svg;
}

// Draws the image windows of one candidate with its number in the table below.
function drawLook(context, trunk, number, theme) {
  const colour = theme.colourOfKind(trunk.label);
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.strokeRect(...trunk.centre);
  context.lineWidth = 0.75;
  context.strokeRect(...trunk.left_edge);
  context.strokeRect(...trunk.right_edge);
  context.font = "600 11px system-ui, 'DejaVu Sans', sans-serif";
  context.textAlign = "center";
  const x = trunk.centre[0] + trunk.centre[2] / 2, y = Math.max(12, trunk.left_edge[1] - 4);
  context.lineWidth = 3;
  context.strokeStyle = "#000b";
  context.strokeText(String(number), x, y);
  context.fillStyle = "#fff";
  context.fillText(String(number), x, y);
}

// Lists all confidences of each candidate, as fused in figure 4 of the paper.
function lookTable(trunks, theme) {
  const head = ["#", "tree", "laser", "colour", "left", "right", "parallel"];
  const lines = trunks.map((trunk, k) => {
    const number = element("td", { textContent: String(k + 1) });
    number.style.color = theme.colourOfKind(trunk.label);
    return element("tr", {}, number, ...head.slice(1).map((name) =>
      element("td", { textContent: trunk[name].toFixed(2) })));
  });
  return element("table", {}, element("tr", {}, ...head.map((words) => element("th", { textContent: words }))), ...lines);
}
