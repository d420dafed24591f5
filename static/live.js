// The light bar's socket: hears messages, answers each when it has been dealt with, notices silence and lateness, and
// finds its way back to a console that was away.

const SILENT_AFTER = 800; // ms without a message, or of lateness, before nothing is believed any more
const HANG_UP_AFTER = 3000; // ms of silence before the socket is replaced
const RETRY = 500;
const LATENESS_WINDOW = 15000;

/** How much later than the quickest of the last half minute a message has come, in ms. */
function makeLateness() {
  let since = performance.now();
  let least = Infinity;
  let before = Infinity;
  return (sent) => {
    const now = performance.now();
    if (now - since > LATENESS_WINDOW) {
      before = least;
      least = Infinity;
      since = now;
    }
    least = Math.min(least, now - sent);
    return now - sent - Math.min(least, before);
  };
}

/**
 * Listens until the page is closed. `onMessage` gets each message of the bar that has come in time, `onStyle` the others,
 * `onSilence` is called when nothing is to be believed any more; `shared` keeps what a test wants to know.
 */
export function listen({ onMessage, onStyle, onSilence, shared }) {
  let socket = null;
  let opened = 0;
  let lateness = makeLateness();

  const hear = (event) => {
    const heard = performance.now();
    const message = JSON.parse(event.data);
    if (message.style) {
      onStyle(message.style);
      return;
    }
    if (lateness(message.t) < SILENT_AFTER) {
      shared.lastHeard = heard;
      shared.silentSince = null;
      onMessage(message);
    }
    event.target.send(String(message.t));
    const drawn = performance.now();
    shared.timings.push({
      sequence: message.q,
      age: message.a ?? null,
      sent: message.t,
      drawn: performance.timeOrigin + drawn,
      took: drawn - heard,
    });
    if (shared.timings.length > 1000) shared.timings.splice(0, 500);
  };

  const connect = () => {
    opened = performance.now();
    lateness = makeLateness();
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const mine = new WebSocket(`${scheme}//${location.host}/live`);
    socket = mine;
    mine.onopen = () => (shared.connections += 1);
    mine.onmessage = hear;
    mine.onclose = () => {
      if (socket !== mine) return;
      socket = null;
      setTimeout(reconnect, RETRY);
    };
  };

  // A console that was started anew asks for its PIN: then the page itself has to be asked for.
  const reconnect = async () => {
    try {
      const answer = await fetch("/", { method: "HEAD", cache: "no-store" });
      if (answer.status === 401) location.reload();
      else connect();
    } catch {
      setTimeout(reconnect, RETRY);
    }
  };

  const watch = () => {
    const now = performance.now();
    if (now - shared.lastHeard <= SILENT_AFTER) return;
    if (shared.silentSince === null) {
      shared.silentSince = now;
      onSilence();
    }
    if (socket && now - Math.max(shared.silentSince, opened) > HANG_UP_AFTER) {
      const old = socket;
      socket = null;
      old.close();
      reconnect();
    }
  };

  connect();
  setInterval(watch, 100);
}
