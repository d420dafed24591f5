// The light bar and the prediction bar, drawn from the messages of /live (their members: guidance_app/view/bar.py).
// Everything that can be wrong was decided on the server; this file draws, and says NO DATA when it hears nothing.
"use strict";

(() => {
  const SILENT_AFTER = 800; // ms without a message, or of lateness, before nothing is believed any more
  const HANG_UP_AFTER = 3000; // ms of silence before the socket is replaced
  const RETRY = 500;
  const LATENESS_WINDOW = 15000;
  const ALARM_GAP = 10000;
  const LEAN_SHOWN = 3; // a lean is a few degrees; it is drawn so much larger
  const LEAN_MOST = 60;

  const element = (kind, name, parent, text = "") => {
    const made = document.createElement(kind);
    made.className = name;
    made.textContent = text;
    parent.append(made);
    return made;
  };
  const setText = (target, text) => {
    if (target.textContent !== text) target.textContent = text;
  };
  const sentence = (words) => words.charAt(0).toUpperCase() + words.slice(1);

  // --- the frame: canvas over the full width, words at both sides ---
  const bar = document.createElement("header");
  bar.id = "lightbar";
  const canvas = element("canvas", "", bar);
  canvas.setAttribute("role", "img");
  const left = element("div", "side left", bar);
  const right = element("div", "side right", bar);
  const passLine = element("div", "pass", left);
  const turnLine = element("div", "turn", left);
  const workLine = element("div", "work", left);
  const speedLine = element("div", "speed", right);
  const speedNumber = element("span", "number", speedLine);
  const speedUnit = element("span", "unit", speedLine);
  const fixLine = element("div", "fix", right);
  const areaLine = element("div", "area", right);
  document.body.append(bar);

  const pen = canvas.getContext("2d");
  const style = { speed: "", zones: "gggyyyrr", guided: "tractor", ahead: "", sounds: false, start: null };
  const shared = {
    message: null,
    state: "opening",
    drawn: null,
    draws: 0,
    timings: [],
    connections: 0,
  };
  window.__lightbar = shared;

  let size = { width: 0, height: 0, side: 0, gutter: 0 };
  let colours = {};
  let silentSince = performance.now();
  let lastHeard = performance.now();

  const readColours = () => {
    const computed = getComputedStyle(bar);
    colours = {};
    for (const name of ["ground", "edge", "ink", "dim", "hollow", "off", "green", "yellow", "red", "on-green", "track", "mark"]) {
      colours[name] = computed.getPropertyValue(`--${name}`).trim();
    }
    const root = getComputedStyle(document.documentElement);
    size.side = root.getPropertyValue("--side").trim();
    size.gutter = parseFloat(root.getPropertyValue("--gutter")) || 0;
  };

  // --- drawing ---
  const font = (pixels, weight = 700) => {
    pen.font = `${weight} ${pixels}px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif`;
  };
  const words = (text, x, y, colour, align = "center") => {
    pen.fillStyle = colour;
    pen.textAlign = align;
    pen.textBaseline = "middle";
    pen.fillText(text, x, y);
  };
  const box = (x, y, width, height, radius) => {
    pen.beginPath();
    pen.roundRect(x, y, width, height, radius);
  };
  const zoneColour = (lamp) => colours[{ g: "green", y: "yellow", r: "red" }[style.zones[lamp - 1]] ?? "green"];

  // Where everything goes: the same for every message of one size.
  const layout = () => {
    const { width, height } = size;
    const phone = width <= 600;
    const side = phone ? 8 : parseFloat(size.side) + 8;
    const inner = { from: side + size.gutter, to: width - side - size.gutter };
    const span = inner.to - inner.from;
    const rowTop = phone ? 8 : 12;
    const rowHeight = phone ? 58 : 66;
    const pill = Math.min(Math.max(span * 0.38, phone ? 138 : 190), 262);
    const trackTop = rowTop + rowHeight + (phone ? 8 : 10);
    const trackHeight = phone ? 24 : 26;
    return { width, height, phone, side, ...inner, span, rowTop, rowHeight, pill, trackTop, trackHeight, middle: width / 2 };
  };

  // One lamp: an arrow head that points where to steer, larger the farther out it stands.
  const lamp = (x, width, place, number, direction, paint) => {
    const tall = place.rowHeight * (0.46 + (0.54 * number) / style.zones.length);
    const top = place.rowTop + (place.rowHeight - tall) / 2;
    const thick = Math.min(width * 0.5, 16);
    const deep = Math.max(2, Math.min(width - thick - 3, tall * 0.4));
    const back = direction > 0 ? x - (thick + deep) / 2 : x + (thick + deep) / 2;
    const at = (forward) => back + direction * forward;
    pen.beginPath();
    pen.moveTo(at(0), top);
    pen.lineTo(at(thick), top);
    pen.lineTo(at(thick + deep), top + tall / 2);
    pen.lineTo(at(thick), top + tall);
    pen.lineTo(at(0), top + tall);
    pen.lineTo(at(deep), top + tall / 2);
    pen.closePath();
    pen.lineJoin = "round";
    paint();
  };

  const lamps = (place, lit) => {
    const count = style.zones.length;
    const room = (place.span - place.pill) / 2 - 8;
    const width = room / count;
    const colour = lit ? zoneColour(Math.abs(lit)) : colours.off;
    for (const direction of [-1, 1]) {
      for (let number = 1; number <= count; number++) {
        const x = place.middle + direction * (place.pill / 2 + 8 + (number - 0.5) * width);
        const on = lit !== null && Math.sign(lit) === direction && number <= Math.abs(lit);
        lamp(x, width, place, number, direction, () => {
          if (lit === null) {
            pen.strokeStyle = colours.hollow;
            pen.lineWidth = 1.5;
            pen.stroke();
          } else {
            pen.fillStyle = on ? colour : colours.off;
            pen.fill();
          }
        });
      }
    }
  };

  // An arrow beside the number: the side to steer to.
  const steerArrow = (x, y, height, direction, colour) => {
    pen.beginPath();
    pen.moveTo(x + direction * height * 0.42, y);
    pen.lineTo(x - direction * height * 0.32, y - height / 2);
    pen.lineTo(x - direction * height * 0.32, y + height / 2);
    pen.closePath();
    pen.fillStyle = colour;
    pen.fill();
  };

  const number = (place, message) => {
    const [amount, unit] = message.d.split(" ");
    const direction = amount === "0" ? 0 : -Math.sign(message.x);
    const onLine = message.k === 0;
    const x = place.middle - place.pill / 2;
    box(x, place.rowTop, place.pill, place.rowHeight, 12);
    pen.fillStyle = onLine ? colours.green : colours.ground;
    pen.fill();
    if (!onLine) {
      pen.strokeStyle = zoneColour(Math.abs(message.k));
      pen.lineWidth = 3;
      box(x + 1.5, place.rowTop + 1.5, place.pill - 3, place.rowHeight - 3, 11);
      pen.stroke();
    }
    const ink = onLine ? colours["on-green"] : colours.ink;
    const large = place.phone ? 42 : 60;
    const small = place.phone ? 16 : 22;
    const y = place.rowTop + place.rowHeight / 2 + large * 0.04;
    font(large);
    const amountWidth = pen.measureText(amount).width;
    font(small, 600);
    const unitWidth = pen.measureText(unit).width + 4;
    const start = place.middle - (amountWidth + unitWidth) / 2;
    font(large);
    words(amount, start, y, ink, "left");
    font(small, 600);
    words(unit, start + amountWidth + 4, y + large * 0.17, ink, "left");
    if (direction) {
      const reach = place.pill / 2 - (place.phone ? 18 : 30);
      steerArrow(place.middle + direction * reach, place.rowTop + place.rowHeight / 2, large * 0.62, direction,
        onLine ? ink : zoneColour(Math.abs(message.k)));
    }
    return direction;
  };

  const track = (place, hollow) => {
    box(place.from, place.trackTop, place.span, place.trackHeight, place.trackHeight / 2);
    if (hollow) {
      pen.strokeStyle = colours.hollow;
      pen.lineWidth = 1.5;
      pen.setLineDash([5, 5]);
      pen.stroke();
      pen.setLineDash([]);
      return;
    }
    pen.fillStyle = colours.track;
    pen.fill();
  };

  const predictionReach = (place) => place.span / 2 - place.trackHeight;

  const ticks = (place) => {
    pen.fillStyle = colours.hollow;
    for (let step = 1; step <= style.zones.length; step++) {
      for (const direction of [-1, 1]) {
        const x = place.middle + (direction * predictionReach(place) * step) / style.zones.length;
        pen.fillRect(x - 0.75, place.trackTop + place.trackHeight - 7, 1.5, 4);
      }
    }
  };

  // The mark leans as the tractor will stand to the line, and a band joins it to the middle.
  const prediction = (place, message) => {
    track(place, message.p === undefined);
    if (message.p === undefined) return;
    ticks(place);
    const x = place.middle + (message.p / 1000) * predictionReach(place);
    const y = place.trackTop + place.trackHeight / 2;
    pen.globalAlpha = 0.35;
    pen.fillStyle = colours.mark;
    pen.fillRect(Math.min(x, place.middle), y - 5, Math.abs(x - place.middle), 10);
    pen.globalAlpha = 1;
    pen.fillStyle = colours.ink;
    pen.fillRect(place.middle - 2, place.trackTop - 3, 4, place.trackHeight + 6);
    const lean = Math.max(-LEAN_MOST, Math.min(LEAN_MOST, (message.h ?? 0) * LEAN_SHOWN));
    const tall = place.trackHeight / 2 + 3;
    pen.save();
    pen.translate(x, y);
    pen.rotate((lean * Math.PI) / 180);
    pen.beginPath();
    pen.moveTo(0, -tall);
    pen.lineTo(tall * 0.82, tall * 0.86);
    pen.lineTo(0, tall * 0.44);
    pen.lineTo(-tall * 0.82, tall * 0.86);
    pen.closePath();
    pen.lineJoin = "round";
    pen.lineWidth = 5;
    pen.strokeStyle = colours.ground;
    pen.stroke();
    pen.fillStyle = colours.mark;
    pen.fill();
    pen.restore();
    if (place.phone) return;
    const beside = message.p >= 0 ? 1 : -1;
    const inside = Math.abs(message.p) > 800 ? -1 : 1;
    font(15, 650);
    words(message.e, x + beside * inside * (tall + 8), y + 1, colours.ink, beside * inside > 0 ? "left" : "right");
  };

  const labels = (place) => {
    if (place.phone) {
      font(12, 650);
      words("HEADING", place.from + 12, place.trackTop + place.trackHeight / 2 + 1, colours.dim, "left");
      words(style.ahead, place.to - 12, place.trackTop + place.trackHeight / 2 + 1, colours.dim, "right");
      return;
    }
    if (!size.gutter) return;
    font(13, 650);
    const row = place.rowTop + place.rowHeight / 2;
    const trackRow = place.trackTop + place.trackHeight / 2 + 1;
    words("STEER", place.from - 14, row, colours.dim, "right");
    words(style.guided.toUpperCase(), place.to + 14, row, colours.dim, "left");
    words("HEADING", place.from - 14, trackRow, colours.dim, "right");
    words(style.ahead && `IN ${style.ahead}`, place.to + 14, trackRow, colours.dim, "left");
  };

  // Nothing to steer by: hollow lamps, and the reason over them in words.
  const why = () => sentence(shared.message?.r ?? "connecting");

  const hollow = (place, reason) => {
    lamps(place, null);
    track(place, true);
    let pixels = place.phone ? 24 : 34;
    font(pixels);
    while (pixels > 13 && pen.measureText(reason).width > place.span - 40) font((pixels -= 1));
    const width = Math.max(place.pill, pen.measureText(reason).width + 36);
    box(place.middle - width / 2, place.rowTop + 1, width, place.rowHeight - 2, 12);
    pen.fillStyle = colours.ground;
    pen.fill();
    pen.strokeStyle = colours.hollow;
    pen.lineWidth = 2;
    pen.stroke();
    words(reason, place.middle, place.rowTop + place.rowHeight / 2 + 2, colours.ink);
  };

  const noData = (place) => {
    font(place.phone ? 40 : 56);
    words("NO DATA", place.middle, place.height / 2 - (place.phone ? 14 : 10), "#ffffff");
    font(place.phone ? 15 : 18, 500);
    words("The console does not answer", place.middle, place.height / 2 + (place.phone ? 24 : 34), "#ffffff");
  };

  const draw = () => {
    const { message, state } = shared;
    const place = layout();
    pen.clearRect(0, 0, place.width, place.height);
    let direction = null;
    if (state === "silent") {
      noData(place);
    } else if (state === "guide") {
      lamps(place, message.k);
      direction = number(place, message);
      prediction(place, message);
      labels(place);
    } else {
      hollow(place, why());
      labels(place);
    }
    shared.draws += 1;
    shared.drawn = {
      state,
      lamps: state === "guide" ? message.k : null,
      number: state === "guide" ? message.d : null,
      steer: direction === null ? null : ["left", "none", "right"][direction + 1],
      prediction: state === "guide" && message.p !== undefined ? message.p / 1000 : null,
      reason: state === "guide" ? null : state === "silent" ? "NO DATA" : why(),
    };
  };

  // --- words at the sides, for eyes, screen readers and tests ---
  const mirror = () => {
    const { message, state } = shared;
    const known = state === "silent" ? {} : (message ?? {});
    bar.dataset.state = state;
    bar.dataset.crossTrack = known.x === undefined ? "" : (known.x / 1000).toFixed(3);
    bar.dataset.lamps = known.k ?? "";
    bar.dataset.number = known.d ?? "";
    bar.dataset.sequence = known.q ?? "";
    bar.dataset.fixAge = known.a === undefined ? "" : (known.a / 1000).toFixed(3);
    setText(passLine, known.n ?? "");
    const [distance, seconds, level, fits] = known.u ?? ["", "", "far", 1];
    setText(turnLine, distance && `turn ${distance}${seconds && ` · ${seconds}`}${fits ? "" : " · tight"}`);
    turnLine.dataset.level = level;
    setText(workLine, known.w === undefined ? "" : known.w ? "working" : "implement up");
    workLine.dataset.down = known.w ?? "";
    setText(speedNumber, known.v ?? "");
    setText(speedUnit, known.v ? style.speed : "");
    setText(fixLine, known.f ?? "");
    setText(areaLine, known.c ?? "");
    const { steer, number: shown, reason } = shared.drawn;
    const spoken = reason ?? (steer === "none" ? "on the line" : `steer ${steer} ${shown}`);
    if (canvas.getAttribute("aria-label") !== spoken) canvas.setAttribute("aria-label", spoken);
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
    if (state === "silent" && before !== "silent") silentSince = performance.now();
    if (state !== before) bar.dataset.state = state;
    draw();
    mirror();
    alarm(before);
  };

  const fit = () => {
    const ratio = window.devicePixelRatio || 1;
    readColours();
    size = { ...size, width: bar.clientWidth, height: bar.clientHeight };
    size.side = right.offsetWidth;
    canvas.width = Math.round(size.width * ratio);
    canvas.height = Math.round(size.height * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    show(shared.state);
  };

  // --- late messages: the least delay seen in half a minute counts as none ---
  let delays = { since: 0, least: Infinity, before: Infinity };
  const lateness = (sent) => {
    const now = performance.now();
    if (now - delays.since > LATENESS_WINDOW) delays = { since: now, least: Infinity, before: delays.least };
    const delay = now - sent;
    delays.least = Math.min(delays.least, delay);
    return delay - Math.min(delays.least, delays.before);
  };

  // --- the socket ---
  let socket = null;
  let opening = 0;

  const hear = (event) => {
    const heard = performance.now();
    const message = JSON.parse(event.data);
    if (message.style) {
      const { start } = message.style; // another start of the console: page and viser may be of another version
      if (start && style.start && start !== style.start) location.reload();
      Object.assign(style, message.style);
      return;
    }
    const late = lateness(message.t);
    shared.message = message;
    if (late < SILENT_AFTER) {
      lastHeard = heard;
      show(message.s);
    }
    event.target.send(String(message.t));
    shared.timings.push({
      sequence: message.q,
      age: message.a ?? null,
      sent: message.t,
      drawn: performance.timeOrigin + performance.now(),
      took: performance.now() - heard,
    });
    if (shared.timings.length > 1000) shared.timings.splice(0, 500);
  };

  const connect = () => {
    opening = performance.now();
    delays = { since: opening, least: Infinity, before: Infinity };
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const mine = new WebSocket(`${scheme}//${location.host}/live`);
    socket = mine;
    mine.onopen = () => {
      shared.connections += 1;
    };
    mine.onmessage = hear;
    mine.onclose = () => {
      if (socket === mine) {
        socket = null;
        setTimeout(reconnect, RETRY);
      }
    };
  };

  // A console that was started anew asks for its PIN: then the page itself has to be asked for.
  const reconnect = async () => {
    try {
      const answer = await fetch("/", { method: "HEAD", cache: "no-store" });
      if (answer.status === 401) {
        location.reload();
        return;
      }
      connect();
    } catch {
      setTimeout(reconnect, RETRY);
    }
  };

  const watch = () => {
    const now = performance.now();
    const quiet = now - lastHeard;
    if (quiet > SILENT_AFTER && shared.state !== "silent") show("silent");
    if (socket && shared.state === "silent" && now - Math.max(silentSince, opening, lastHeard) > HANG_UP_AFTER) {
      const old = socket;
      socket = null;
      old.close();
      reconnect();
    }
  };

  new ResizeObserver(fit).observe(bar);
  __page.onNight((night) => {
    bar.dataset.palette = night ? "night" : "day";
    fit();
  });
  connect();
  setInterval(watch, 100);
})();
