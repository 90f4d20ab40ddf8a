// Short forms for corrections.

class EditForms {
  constructor(box) {
    this.box = box;
  }

  // Asks for `fields` [{name, label, type, value}] and calls `done(values)`.
  ask(title, fields, done) {
    const inputs = fields.map(({ name, label, type, value }) =>
      element("label", {}, element("span", { textContent: label }),
        element("input", { name, type: type || "text", value: value === undefined ? "" : String(value), maxLength: 500,
          autocomplete: "off" })));
    const cancel = element("button", { type: "button", textContent: "Cancel" });
    cancel.addEventListener("click", () => this.clear());
    const form = element("form", { id: "edit-form" }, element("strong", { textContent: title }), ...inputs,
      element("div", { className: "steps" }, element("button", { type: "submit", textContent: "Save" }), cancel));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const values = {};
      for (const input of form.querySelectorAll("input")) values[input.name] = input.value.trim();
      this.clear();
      done(values);
    });
    this.box.replaceChildren(form);
    form.querySelector("input").focus();
  }

  // Shows what to click; `cancel` is called when the user cancels.
  say(words, cancel) {
    const button = element("button", { type: "button", textContent: "Cancel" });
    button.addEventListener("click", () => { this.clear(); cancel(); });
    this.box.replaceChildren(element("p", { id: "edit-asks" }, words, " ", button));
  }

  clear() { this.box.replaceChildren(); }
}
