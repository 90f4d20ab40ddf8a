// Manual corrections: clicks become lines in the map's list of corrections, which the server
// stores.

class Editor {
  constructor(app) {
    this.app = app;
    this.pick = null; // purpose of the next clicks on the map: {count, wantsLandmark, places, done}
    this.forms = new EditForms(element("div", {}));
    this.status = element("p", { id: "edit-status" });
    this.status.setAttribute("role", "status");
    const button = (id, words, title, act) => {
      const made = element("button", { type: "button", id, textContent: words, title });
      made.addEventListener("click", act);
      return made;
    };
    this.undoButton = button("undo", "↶ Undo", "Undo the last correction", () => this.send({ what: "undo" }));
    this.redoButton = button("redo", "↷ Redo", "Redo the last undone correction", () => this.send({ what: "redo" }));
    this.undoButton.disabled = this.redoButton.disabled = true;
    this.who = element("input", { id: "who", placeholder: "Your name", maxLength: 60, value: remembered("orchard-who") || app.data.who || "" });
    this.who.setAttribute("aria-label", "Your name, for the list of corrections");
    this.who.addEventListener("change", () => remember("orchard-who", this.who.value));
    byId("edit").replaceChildren(
      element("div", { className: "steps" }, button("add", "+ Add", "Add a tree that the map lacks", () => this.add()),
        this.undoButton, this.redoButton), this.who, this.forms.box, this.status);
    byId("edit").hidden = false;
    app.details.actions = (i) => this.actionsOf(i);
    app.details.gapActions = (row, gap) => [this.action("add-here", "Add a tree here",
      () => this.send({ what: "add", places_m: [[gap[1], gap[2]]] }))];
    document.addEventListener("keydown", (event) => { if (event.key === "Escape") this.stopPicking(); });
  }

  action(id, words, act) {
    const made = element("button", { type: "button", id: `edit-${id}`, textContent: words });
    made.addEventListener("click", act);
    return made;
  }

  actionsOf(i) {
    const { columns } = this.app.model;
    const id = String(columns.id[i]);
    const isTree = this.app.model.isTrunk(i);
    return [
      this.action("delete", "Delete", () => this.send({ what: "delete", trees: [id] })),
      this.action("class", isTree ? "Not a tree" : "Tree",
        () => this.send({ what: "class", trees: [id], class: isTree ? "object" : "tree" })),
      this.action("move", "Move", () => this.pickPlaces(1, "Click the true position.",
        (places) => this.send({ what: "move", trees: [id], places_m: places }))),
      this.action("merge", "Merge with …", () => this.pickLandmark("Click the other landmark.",
        (other) => this.send({ what: "merge", trees: [id, String(other)] }))),
      this.action("split", "Split", () => this.pickPlaces(2, "Click the position of the first, then of the second.",
        (places) => this.send({ what: "split", trees: [id], places_m: places }))),
      this.action("renumber", "Number", () => this.ask(`Row and number of ${id}`,
        [{ name: "row", label: "Row", value: columns.row[i] || "" },
          { name: "position", label: "Tree", type: "number", value: columns.position[i] || "" }],
        ({ row, position }) => this.send({ what: "renumber", trees: [id], row, position: Number(position) }))),
      this.action("note", "Note", () => this.ask(`Note on ${id}`, [{ name: "note", label: "Text" }],
        ({ note }) => this.send({ what: "note", trees: [id], note }))),
    ];
  }

  add() {
    this.pickPlaces(1, "Click the position of the tree.", (places) => this.send({ what: "add", places_m: places }));
  }

  renameRow(row) {
    this.ask(`Name of row ${row.number}`, [{ name: "name", label: "Name", value: this.app.model.rowName(row.number) }],
      ({ name }) => this.send({ what: "row", row: String(row.number), name }));
  }

  // Opens a form; ends a pending selection on the map.
  ask(...question) {
    this.stopPicking();
    this.forms.ask(...question);
  }

  pickPlaces(count, words, done) { this.startPicking({ count, done, places: [] }, words); }
  pickLandmark(words, done) { this.startPicking({ count: 1, wantsLandmark: true, done, places: [] }, words); }

  startPicking(pick, words) {
    this.pick = pick;
    this.app.canvas.classList.add("picking");
    this.forms.say(words, () => this.stopPicking());
  }

  stopPicking() {
    if (!this.pick) return;
    this.pick = null;
    this.app.canvas.classList.remove("picking");
    this.forms.clear();
  }

  // Handles a click on the map; returns whether it was part of an edit.
  takeClick(x, y, i) {
    const { pick } = this;
    if (!pick) return false;
    if (pick.wantsLandmark) {
      if (i < 0) return true;
      this.stopPicking();
      pick.done(this.app.model.columns.id[i]);
      return true;
    }
    pick.places.push([Number(x.toFixed(3)), Number(y.toFixed(3))]);
    if (pick.places.length === pick.count) {
      this.stopPicking();
      pick.done(pick.places);
    }
    return true;
  }

  async send(edit) {
    this.stopPicking();
    this.say("…", false);
    try {
      const answer = await fetch("api/edit", { method: "POST", headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ ...edit, who: this.who.value.trim() }) });
      const reply = await answer.json().catch(() => ({ problem: `Not saved: the viewer refused the correction (${answer.status}).` }));
      this.say(reply.words || reply.problem, !answer.ok);
    } catch (error) {
      this.say("Not saved: the viewer does not answer. Check that it is running.", true);
    }
  }

  say(words, isBad) {
    this.status.textContent = words;
    this.status.className = isBad ? "state bad" : "state";
  }

  // Shows the server's list of all corrections, of this page and of others.
  show(event) {
    this.undoButton.disabled = event.can_undo === 0;
    this.redoButton.disabled = event.can_redo === 0;
  }
}

function showCorrections(list) {
  byId("corrections-box").hidden = list.length === 0;
  byId("corrections").replaceChildren(...list.map((entry) => element("li", { className: entry.outcome.replace(" ", "-") },
    `${entry.n}. ${entry.words}`,
    element("small", { textContent: ` ${entry.who}, ${entry.when.slice(0, 10)}, ${entry.outcome}` +
      `${entry.reason ? `: ${entry.reason}` : ""}${entry.note ? ` — ${entry.note}` : ""}` }))));
}

// Stored by the browser for this page; a private window may not allow it.
function remembered(key) {
  try { return localStorage.getItem(key) || ""; } catch { return ""; }
}

function remember(key, value) {
  try { localStorage.setItem(key, value); } catch { /* it is asked for again */ }
}
