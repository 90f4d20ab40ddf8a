// A map folder on a server: corrections made here or elsewhere are shown at once.

class FolderStream {
  constructor(app) {
    this.app = app;
    const source = new EventSource(`api/stream?map=${app.data.revision}`);
    source.onmessage = (message) => this.take(JSON.parse(message.data));
    watchConnection(source);
  }

  take(event) {
    const { app } = this;
    if (event.kind === "hello" && event.boot !== app.data.boot) location.reload(); // another server's map
    else if (event.kind === "overview" && event.tiles.stamp === app.tiles.stamp) return; // the page began with it
    else if (event.kind === "overview") app.tiles.renew(event);
    else if (event.kind === "map" && app.tiles) return; // the overview follows
    else if (event.kind === "map") takeLandmarks(app.model, event);
    else if (event.kind === "rows") app.model.setRows(event.rows, event.ways);
    else if (event.kind === "corrections") app.takeCorrections(event);
    app.refreshLists();
  }
}
