// The bar's own life, from message to picture. It runs in a worker, so that it hears, draws and notices silence while the
// page is busy with the 3D scene; in a browser that cannot draw from a worker it runs on the page.

import { makeBars } from "./bars.js";
import { listen } from "./live.js";

const epoch = (moment) => (moment === null ? null : performance.timeOrigin + moment);

// What is said before the console has told its words.
const UNTOLD = {
  connecting: "Connecting",
  noData: "NO DATA",
  noAnswer: "The console does not answer",
  onTheLine: "",
  steerLeft: "",
  steerRight: "",
  heading: "",
  ahead: "",
  turn: "",
  inTurn: "",
  onTheTurn: "",
  tight: "",
  working: "",
  lifted: "",
  paused: "",
  notSent: "{file} could not be sent",
};

/** Draws on `canvas` for good. `tell` gets news for the page: what stands on the canvas, and what it was drawn from. */
export function runBar(canvas, tell) {
  const style = { speed: "", zones: "gggyyyrr", guided: "", sounds: false, start: null, language: "en", words: UNTOLD };
  const bars = makeBars(canvas, style);
  let state = "opening";
  let message = null;
  let fitted = false;

  const reason = () => {
    if (state === "guide") return null;
    if (state === "silent") return style.words.noData;
    const words = message?.r ?? style.words.connecting;
    return words.charAt(0).toUpperCase() + words.slice(1);
  };

  const show = (next, heard = null) => {
    state = next;
    if (!fitted) return;
    const drawn = bars.draw(state, message, reason());
    const done = performance.now();
    tell({
      state,
      drawn,
      style,
      message: state === "silent" ? null : message,
      connections: contact.connections,
      lastHeard: epoch(contact.lastHeard),
      silentSince: epoch(contact.silentSince),
      lookedBefore: epoch(contact.lookedBefore),
      silentAfter: contact.silentAfter,
      lookEvery: contact.lookEvery,
      timing: heard && {
        sequence: message.q,
        age: message.a ?? null,
        sent: message.t,
        drawn: epoch(done),
        took: done - heard,
      },
    });
  };

  const contact = listen({
    onMessage: (heardMessage, heard) => {
      message = heardMessage;
      show(message.s, heard);
    },
    onStyle: (changed) => {
      const { start } = changed; // of another start of the console: page and viser may be of another version
      if (start && style.start && start !== style.start) tell({ reload: true });
      Object.assign(style, changed);
    },
    onSilence: () => show("silent"),
    onShutOut: () => tell({ reload: true }),
  });

  return {
    fit: (look) => {
      fitted = true;
      bars.fit(look);
      show(state);
    },
  };
}
