// Short forms in which people say what they know better.

class EditForms {
  constructor(box) {
    this.box = box;
  }

  // Asks for `fields` [{name, label, type, value}]; `done(values)` when they are given.
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

  // Says what to click; `cancel` is called when people do not want to.
  say(words, cancel) {
    const button = element("button", { type: "button", textContent: "Cancel" });
    button.addEventListener("click", () => { this.clear(); cancel(); });
    this.box.replaceChildren(element("p", { id: "edit-asks" }, words, " ", button));
  }

  clear() { this.box.replaceChildren(); }
}
