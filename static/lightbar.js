// The light bar across the top of the page: the frame, the words at both sides, the alarms. What it shows was decided on
// the server (guidance_app/view/bar.py); the bars themselves are drawn by runbar.js.

import { COLOURS } from "./bars.js";
import { runBar } from "./runbar.js";

const ALARM_GAP = 10000;
const TIMINGS = 1000;

const shared = {
  message: null, // the newest that was believed; null while nothing is
  state: "opening",
  drawn: null, // what stands on the canvas
  timings: [],
  connections: 0,
  lastHeard: null,
  silentSince: null,
  lookedBefore: null, // the look before the one that found silence
  silentAfter: null,
  lookEvery: null,
  worker: false,
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

// --- what is said beside the bars, to eyes, screen readers and tests ---
const sayAttributes = (known, { words, language }) => {
  bar.dataset.state = shared.state;
  bar.dataset.crossTrack = known.x === undefined ? "" : (known.x / 1000).toFixed(3);
  bar.dataset.lamps = known.k ?? "";
  bar.dataset.number = known.d ?? "";
  bar.dataset.sequence = known.q ?? "";
  bar.dataset.fixAge = known.a === undefined ? "" : (known.a / 1000).toFixed(3);
  const { steer, number, reason } = shared.drawn;
  const steering = { none: known.m ? words.onTheTurn : words.onTheLine, left: `${words.steerLeft} ${number}`, right: `${words.steerRight} ${number}` };
  const spoken = reason ?? steering[steer];
  if (document.documentElement.lang !== language) document.documentElement.lang = language;
  if (canvas.getAttribute("aria-label") !== spoken) canvas.setAttribute("aria-label", spoken);
};

const sayWords = (known, style) => {
  const [, name, detail] = /^(.*? ?)(\(.*\))?$/.exec(known.n ?? "");
  setText(passName, name);
  setText(passDetail, detail ?? "");
  const [distance, seconds, level, fits] = known.u ?? ["", "", "far", 1];
  const { words } = style;
  const turn = [(known.m ? words.inTurn : words.turn).replace("{distance}", distance), seconds, fits ? "" : words.tight];
  setText(turnLine, distance && turn.filter((part) => part).join(" · "));
  turnLine.dataset.level = level;
  setText(workLine, known.w === undefined ? "" : known.z ? words.paused : known.w ? words.working : words.lifted);
  workLine.dataset.down = known.w ?? "";
  workLine.dataset.paused = known.z ?? "";
  setText(speedNumber, known.v ?? "");
  setText(speedUnit, known.v ? style.speed : "");
  setText(fixLine, known.f ?? "");
  setText(guidedPoint, known.c === undefined ? "" : style.guided);
  setText(workedArea, known.c ?? "");
};

// --- alarms: one for a change for the worse, never two within ten seconds ---
const STEERED_BY = ["guide", "across"];
let lastAlarm = -ALARM_GAP;
let lastLevel = "far";

const alarm = (before, sounds) => {
  const level = shared.state === "guide" ? (shared.message.u?.[2] ?? "far") : lastLevel;
  const lost = STEERED_BY.includes(before) && ![...STEERED_BY, "measuring", "finished"].includes(shared.state);
  const turning = level === "now" && lastLevel !== "now";
  lastLevel = level;
  if (!sounds || !(lost || turning) || performance.now() - lastAlarm < ALARM_GAP) return;
  const sounded = lost ? __page.beep(520, 160) && __page.beep(390, 240, 200) : __page.beep(880, 140);
  if (sounded) lastAlarm = performance.now();
};

const hear = ({ reload, style, timing, ...news }) => {
  if (reload) {
    location.reload();
    return;
  }
  const before = shared.state;
  if (style) __page.words = style.words;
  Object.assign(shared, news);
  if (timing) shared.timings.push(timing);
  if (shared.timings.length > TIMINGS) shared.timings.splice(0, TIMINGS / 2);
  const known = shared.message ?? {};
  sayAttributes(known, style);
  sayWords(known, style);
  alarm(before, style.sounds);
};

// --- the bars, in a worker where the browser can ---
const look = () => {
  const computed = getComputedStyle(bar);
  return {
    width: bar.clientWidth,
    height: bar.clientHeight,
    side: right.offsetWidth,
    ratio: window.devicePixelRatio || 1,
    colours: Object.fromEntries(COLOURS.map((name) => [name, computed.getPropertyValue(`--${name}`).trim()])),
  };
};

const start = () => {
  if (!canvas.transferControlToOffscreen) return runBar(canvas, hear);
  const worker = new Worker("/static/barworker.js", { type: "module" });
  worker.onmessage = ({ data }) => hear(data);
  const drawnOn = canvas.transferControlToOffscreen();
  worker.postMessage({ canvas: drawnOn }, [drawnOn]);
  shared.worker = true;
  return { fit: (seen) => worker.postMessage({ look: seen }) };
};

const running = start();
new ResizeObserver(() => running.fit(look())).observe(bar);
__page.onNight((night) => {
  bar.dataset.palette = night ? "night" : "day";
  running.fit(look());
});
