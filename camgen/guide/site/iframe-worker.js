// A page opened as a file may start no worker: there the search runs in a hidden frame, as if it were one.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.body.appendChild(document.createElement("iframe"));
      frame.hidden = true;
      const scope = frame.contentWindow;
      const loaded = (source) => new Promise((done) => {
        const script = scope.document.createElement("script");
        script.src = source;
        script.onload = script.onerror = done;
        scope.document.body.appendChild(script);
      });
      scope.importScripts = (...sources) => sources.reduce((before, source) => before.then(() => loaded(source)), Promise.resolve());
      scope.postMessage = (data) => {
        const message = new MessageEvent("message", { data });
        this.dispatchEvent(message);
        if (this.onmessage) this.onmessage(message);
      };
      this.frame = frame;
      this.ready = loaded(new URL(url, location.href).href);
    }
    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data })));
    }
    terminate() {
      this.frame.remove();
    }
  };
}
