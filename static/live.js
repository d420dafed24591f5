// The light bar's socket: hears messages, answers each when it has been dealt with, notices silence and lateness, and
// finds its way back to a console that was away. Runs in a worker or on the page.

const SILENT_AFTER = 800; // ms without a message, or of lateness, before nothing is believed any more
const LOOK_EVERY = 100;
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
 * Listens for good. `onMessage` gets each message of the bar that has come in time and the moment it came, `onStyle` the
 * rarer ones about its style, `onSilence` is called when nothing is to be believed any more, `onShutOut` when the console
 * no longer knows this browser. Gives a record of the contact: sockets opened so far, last message heard, silence begun,
 * the look before that one, after how many ms silence counts, and how often is looked.
 */
export function listen({ onMessage, onStyle, onSilence, onShutOut }) {
  const contact = {
    connections: 0,
    lastHeard: performance.now(),
    silentSince: null,
    lookedBefore: null,
    silentAfter: SILENT_AFTER,
    lookEvery: LOOK_EVERY,
  };
  let looked = performance.now();
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
      contact.lastHeard = heard;
      contact.silentSince = null;
      onMessage(message, heard);
    }
    event.target.send(String(message.t));
  };

  const connect = () => {
    opened = performance.now();
    lateness = makeLateness();
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const mine = new WebSocket(`${scheme}//${location.host}/live`);
    socket = mine;
    mine.onopen = () => (contact.connections += 1);
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
      if (answer.status === 401) onShutOut();
      else connect();
    } catch {
      setTimeout(reconnect, RETRY);
    }
  };

  const watch = () => {
    const now = performance.now();
    const before = looked;
    looked = now;
    if (now - contact.lastHeard <= SILENT_AFTER) return;
    if (contact.silentSince === null) {
      contact.silentSince = now;
      contact.lookedBefore = before;
      onSilence();
    }
    if (socket && now - Math.max(contact.silentSince, opened) > HANG_UP_AFTER) {
      const old = socket;
      socket = null;
      old.close();
      reconnect();
    }
  };

  connect();
  setInterval(watch, LOOK_EVERY);
  return contact;
}
