// What happens, told by the server: one stream for all tabs. A browser keeps six connections to a server, and a
// stream takes one of them for as long as it is open.

import { get } from "./api.js";

const KINDS = ["hello", "job", "run", "changes", "shown", "steps", "effect-text", "other", "files", "goodbye"];
const AGAIN_MS = 2000, NAME = "vmach-events";

// `take(kind, what)` gets the state ("hello") and what happens from then on; "lost" where the server does not answer,
// "ended" where another one answers in its place.
export function listenToServer(take) {
  const channel = new BroadcastChannel(NAME);
  let early = []; // what is told before the state is there
  const hear = (kind, what) => (early ? early.push([kind, what]) : take(kind, what));
  const begin = (state) => {
    const told = early ?? [];
    early = null;
    if (state) take("hello", state);
    for (const [kind, what] of told) take(kind, what);
  };
  channel.onmessage = ({ data }) => hear(data.kind, data.what);
  const tell = (kind, what) => {
    channel.postMessage({ kind, what });
    hear(kind, what);
  };
  get("/api/state").then(begin, () => begin(null));
  navigator.locks.request(NAME, () => new Promise((release) => openStream(tell, release)));
}

// The tab that holds the lock listens, and tells the others; `release` hands that over to another tab.
function openStream(tell, release) {
  const source = new EventSource("/api/events"), again = () => setTimeout(() => openStream(tell, release), AGAIN_MS);
  for (const kind of KINDS) source.addEventListener(kind, (event) => tell(kind, JSON.parse(event.data)));
  source.addEventListener("goodbye", () => { source.close(); release(); });
  source.onerror = async () => {
    if (source.readyState !== EventSource.CLOSED) return tell("lost"); // the browser asks again
    try {
      await get("/api/state");
      again();
    } catch (error) {
      if (error.status !== 403) { tell("lost"); return again(); }
      tell("ended");
      release();
    }
  };
}
