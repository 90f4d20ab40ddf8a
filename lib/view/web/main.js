// Begins.

const data = JSON.parse(byId("map-data").textContent);
const app = new App(data);
if (data.mode === "live") app.live = new Live(app);
globalThis.orchardApp = app; // for whoever looks into the page: tests, a console
