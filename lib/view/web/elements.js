// Creation of page elements. Untrusted text is only inserted as text, never as markup.

function element(name, properties, ...children) {
  const made = document.createElement(name);
  Object.assign(made, properties || {});
  made.append(...children);
  return made;
}

const byId = (id) => document.getElementById(id);

const wholeNumber = (value) => value.toLocaleString("en");
