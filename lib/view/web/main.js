// Begins.

const app = new App(JSON.parse(byId("map-data").textContent));
globalThis.orchardApp = app; // for whoever looks into the page: tests, a console
