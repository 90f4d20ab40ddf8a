// Starts the page.

const data = JSON.parse(byId("map-data").textContent);
const app = new App(data);
if (data.can_edit) app.editor = new Editor(app);
if (data.mode === "live") app.live = new Live(app);
if (data.mode === "folder") app.folder = new FolderStream(app);
if (data.mode === "drive") app.drive = new Drive(app);
if (app.editor) app.refreshLists();
globalThis.orchardApp = app; // for tests and the console
