// Creation of page elements. Untrusted text is only inserted as text, never as markup.

function element(name, properties, ...children) {
  const made = document.createElement(name);
  Object.assign(made, properties || {});
  made.append(...children);
  return made;
}

// Shows that a stream of events has broken off, until it goes on.
function watchConnection(source) {
  const show = (isLost) => {
    document.body.classList.toggle("stale", isLost);
    byId("gone").hidden = !isLost;
  };
  source.addEventListener("error", () => show(true));
  source.addEventListener("open", () => show(false));
}

const byId = (id) => document.getElementById(id);

const wholeNumber = (value) => value.toLocaleString("en");
