// The light bar across the top of the page: bars on a canvas, words at both sides, alarms. What it shows was decided on the
// server (guidance_app/view/bar.py); here it is only shown, and NO DATA when nothing is heard.

import { makeBars } from "./bars.js";
import { listen } from "./live.js";

const ALARM_GAP = 10000;

const style = { speed: "", zones: "gggyyyrr", guided: "tractor", ahead: "", sounds: false, start: null };

const shared = {
  message: null, // the newest that was believed
  state: "opening",
  drawn: null, // what stands on the canvas
  timings: [],
  connections: 0,
  lastHeard: performance.now(),
  silentSince: null,
};
window.__lightbar = shared;

// --- the frame ---
const element = (kind, name, parent) => {
  const made = document.createElement(kind);
  made.className = name;
  parent.append(made);
  return made;
};
const setText = (target, text) => {
  if (target.textContent !== text) target.textContent = text;
};

const bar = document.createElement("header");
bar.id = "lightbar";
const canvas = element("canvas", "", bar);
canvas.setAttribute("role", "img");
const left = element("div", "side left", bar);
const right = element("div", "side right", bar);
const passLine = element("div", "pass", left);
const passName = element("span", "name", passLine);
const passDetail = element("span", "detail", passLine);
const turnLine = element("div", "turn", left);
const workLine = element("div", "work", left);
const speedLine = element("div", "speed", right);
const speedNumber = element("span", "number", speedLine);
const speedUnit = element("span", "unit", speedLine);
const fixLine = element("div", "fix", right);
const lastLine = element("div", "last", right);
const guidedPoint = element("span", "guided", lastLine);
const workedArea = element("span", "area", lastLine);
document.body.append(bar);

const bars = makeBars(canvas, style);

// --- what is said beside the bars, to eyes, screen readers and tests ---
const reason = () => {
  if (shared.state === "silent") return "NO DATA";
  const words = shared.message?.r ?? "connecting";
  return words.charAt(0).toUpperCase() + words.slice(1);
};

const sayAttributes = (known) => {
  bar.dataset.state = shared.state;
  bar.dataset.crossTrack = known.x === undefined ? "" : (known.x / 1000).toFixed(3);
  bar.dataset.lamps = known.k ?? "";
  bar.dataset.number = known.d ?? "";
  bar.dataset.sequence = known.q ?? "";
  bar.dataset.fixAge = known.a === undefined ? "" : (known.a / 1000).toFixed(3);
  const { steer, number, reason: why } = shared.drawn;
  const spoken = why ?? (steer === "none" ? "on the line" : `steer ${steer} ${number}`);
  if (canvas.getAttribute("aria-label") !== spoken) canvas.setAttribute("aria-label", spoken);
};

const sayWords = (known) => {
  const [, name, detail] = /^(.*?)( \(.*\))?$/.exec(known.n ?? "");
  setText(passName, name);
  setText(passDetail, detail ?? "");
  const [distance, seconds, level, fits] = known.u ?? ["", "", "far", 1];
  setText(turnLine, distance && `turn ${distance}${seconds && ` · ${seconds}`}${fits ? "" : " · tight"}`);
  turnLine.dataset.level = level;
  setText(workLine, known.w === undefined ? "" : known.w ? "working" : "implement up");
  workLine.dataset.down = known.w ?? "";
  setText(speedNumber, known.v ?? "");
  setText(speedUnit, known.v ? style.speed : "");
  setText(fixLine, known.f ?? "");
  setText(guidedPoint, known.c === undefined ? "" : style.guided);
  setText(workedArea, known.c ?? "");
};

// --- alarms: one for a change for the worse, never two within ten seconds ---
let lastAlarm = -ALARM_GAP;
let lastLevel = "far";

const alarm = (before) => {
  const level = shared.state === "guide" ? (shared.message.u?.[2] ?? "far") : lastLevel;
  const lost = before === "guide" && shared.state !== "guide";
  const turning = level === "now" && lastLevel !== "now";
  lastLevel = level;
  if (!style.sounds || !(lost || turning) || performance.now() - lastAlarm < ALARM_GAP) return;
  const sounded = lost ? __page.beep(520, 160) && __page.beep(390, 240, 200) : __page.beep(880, 140);
  if (sounded) lastAlarm = performance.now();
};

const show = (state) => {
  const before = shared.state;
  shared.state = state;
  shared.drawn = bars.draw(state, shared.message, state === "guide" ? null : reason());
  const known = state === "silent" ? {} : (shared.message ?? {});
  sayAttributes(known);
  sayWords(known);
  alarm(before);
};

const fit = () => {
  bars.fit(right.offsetWidth);
  show(shared.state);
};
new ResizeObserver(fit).observe(bar);
__page.onNight((night) => {
  bar.dataset.palette = night ? "night" : "day";
  fit();
});

listen({
  shared,
  onMessage: (message) => {
    shared.message = message;
    show(message.s);
  },
  onStyle: (changed) => {
    const { start } = changed; // of another start of the console: page and viser may be of another version
    if (start && style.start && start !== style.start) location.reload();
    Object.assign(style, changed);
  },
  onSilence: () => show("silent"),
});
