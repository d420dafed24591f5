// Draws the light bar and the prediction bar on a canvas: where everything goes, and in what shape and colour. What is
// drawn comes in a message (its members: guidance_app/view/bar.py), colours come from the page's style sheet.

const LEAN_SHOWN = 3; // a lean is a few degrees; it is drawn so much larger
const LEAN_MOST = 60;
export const COLOURS = ["ground", "ink", "dim", "hollow", "off", "green", "yellow", "red", "on-green", "track", "mark"];
const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Noto Sans CJK JP", "DejaVu Sans", sans-serif';

/** The painter of one canvas, on the page or in a worker. `style` is shared with its owner, who changes it;
 * its `words` are what is said here, in the driver's language. */
export function makeBars(canvas, style) {
  const pen = canvas.getContext("2d");
  let size = { width: 0, height: 0, side: 0 };
  let colours = {};

  /** Takes over the look of the page: `width`, `height` and `side` (the words beside the bars) in its pixels, how many
   * of the screen's there are to one (`ratio`), and the `colours` by name. */
  const fit = (look) => {
    size = look;
    colours = look.colours;
    canvas.width = Math.round(look.width * look.ratio);
    canvas.height = Math.round(look.height * look.ratio);
    pen.setTransform(look.ratio, 0, 0, look.ratio, 0, 0);
  };

  // --- drawing ---
  const LABEL = 13;
  const font = (pixels, weight = 700) => {
    pen.font = `${weight} ${pixels}px ${FONT}`;
  };
  const words = (text, x, y, colour, align = "center") => {
    pen.fillStyle = colour;
    pen.textAlign = align;
    pen.textBaseline = "middle";
    pen.fillText(text, x, y);
  };
  const capitals = (text) => text.toLocaleUpperCase(style.language);
  const box = (x, y, width, height, radius) => {
    pen.beginPath();
    pen.roundRect(x, y, width, height, radius);
  };
  const zoneColour = (lamp) => colours[{ g: "green", y: "yellow", r: "red" }[style.zones[lamp - 1]] ?? "green"];

  // Where everything goes: the same for every message of one size.
  const layout = () => {
    const { width, height, side } = size;
    const phone = width <= 600;
    const from = phone ? 8 : side + 10;
    const span = width - 2 * from;
    const low = height < 115; // a phone that lies on its side
    const large = phone || low ? 42 : width < 1150 ? 52 : 57; // of the number: its digits are 0.72 of this high
    const rowTop = phone || low ? 8 : 10;
    const rowHeight = phone || low ? 62 : 74;
    const trackTop = rowTop + rowHeight + (phone ? 7 : low ? 5 : 9);
    const pill = Math.min(large * 4.55, span * 0.48);
    return { width, height, phone, from, span, large, rowTop, rowHeight, pill, trackTop, trackHeight: low ? 22 : 26, middle: width / 2 };
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

  // In a turn the lamps keep one calm colour: a turn is driven to some decimetres, and nothing is wrong.
  const lamps = (place, lit, calm = false) => {
    const count = style.zones.length;
    const room = (place.span - place.pill) / 2 - 6;
    const width = room / count;
    const colour = lit ? (calm ? colours.mark : zoneColour(Math.abs(lit))) : colours.off;
    for (const direction of [-1, 1]) {
      for (let number = 1; number <= count; number++) {
        const x = place.middle + direction * (place.pill / 2 + 6 + (number - 0.5) * width);
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

  // -1 to steer left, 1 right, 0 when the number shows nothing to correct.
  const steerTo = (message) => (message.d.startsWith("0 ") ? 0 : -Math.sign(message.x));

  // The number with its arrow, in a frame that is filled when the tractor is on the line.
  const number = (place, message) => {
    const [amount, unit] = message.d.split(" ");
    const direction = steerTo(message);
    const onLine = message.k === 0;
    const calm = message.m !== undefined;
    const colour = calm ? colours.mark : onLine ? colours.green : zoneColour(Math.abs(message.k));
    const filled = onLine && !calm;
    const ink = filled ? colours["on-green"] : colours.ink;
    box(place.middle - place.pill / 2 + 1.5, place.rowTop + 1.5, place.pill - 3, place.rowHeight - 3, 12);
    pen.fillStyle = filled ? colour : colours.ground;
    pen.fill();
    pen.strokeStyle = colour;
    pen.lineWidth = 3;
    pen.stroke();

    const caption = place.phone ? 11 : 13;
    font(caption, 700);
    const said = message.m ?? style.words[onLine ? "onTheLine" : direction < 0 ? "steerLeft" : "steerRight"];
    words(capitals(said), place.middle, place.rowTop + 12, ink);

    const arrow = place.large * 0.6;
    const room = place.pill - 2 * (arrow * 0.74 + 16);
    let large = place.large;
    let amountWidth, unitWidth;
    do {
      font(large);
      amountWidth = pen.measureText(amount).width;
      font(large * 0.38, 600);
      unitWidth = pen.measureText(unit).width + 3;
    } while (amountWidth + unitWidth > room && (large -= 1) > 20);
    const y = place.rowTop + place.rowHeight / 2 + 8;
    const start = place.middle - (amountWidth + unitWidth) / 2;
    words(unit, start + amountWidth + 3, y + large * 0.19, ink, "left");
    font(large);
    words(amount, start, y + large * 0.04, ink, "left");
    if (direction) {
      const reach = place.pill / 2 - arrow * 0.42 - 12;
      steerArrow(place.middle + direction * reach, y, arrow, direction, filled ? ink : colour);
    }
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

  const predictionReach = (place) => place.span / 2 - (place.phone ? 78 : 104);

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
    // Beside the mark, away from the middle; toward it where the bar's own words stand there; on a short bar not at all.
    font(LABEL, 700);
    const least = place.from + 22 + pen.measureText(capitals(style.words.heading)).width;
    const most = place.from + place.span - 22 - pen.measureText(style.words.ahead).width;
    font(15, 650);
    const reach = tall + 8 + pen.measureText(message.e).width;
    const sides = message.p >= 0 ? [1, -1] : [-1, 1];
    const side = sides.find((one) => (one > 0 ? x + reach <= most : x - reach >= least));
    if (!side) return;
    words(message.e, x + side * (tall + 8), y + 1, colours.ink, side > 0 ? "left" : "right");
  };

  const labels = (place) => {
    const y = place.trackTop + place.trackHeight / 2 + 1;
    font(place.phone ? 11 : LABEL, 700);
    words(capitals(style.words.heading), place.from + 14, y, colours.dim, "left");
    words(style.words.ahead, place.from + place.span - 14, y, colours.dim, "right");
  };

  // Nothing to steer by: hollow lamps, and the reason over them in words.
  const hollow = (place, reason) => {
    lamps(place, null);
    track(place, true);
    const room = place.span - (place.phone ? 40 : 100);
    let lines = [reason];
    let pixels = place.phone ? 24 : 32;
    const widest = () => {
      font(pixels);
      return Math.max(...lines.map((line) => pen.measureText(line).width));
    };
    while (widest() > room && pixels > 12) {
      pixels -= 1;
      if (pixels === 18 && lines.length === 1) {
        lines = inTwo(reason);
        pixels = 22;
      }
    }
    const width = Math.max(place.pill, widest() + 36);
    box(place.middle - width / 2, place.rowTop + 1, width, place.rowHeight - 2, 12);
    pen.fillStyle = colours.ground;
    pen.fill();
    pen.strokeStyle = colours.hollow;
    pen.lineWidth = 2;
    pen.stroke();
    const y = place.rowTop + place.rowHeight / 2 + 2;
    lines.forEach((line, k) => words(line, place.middle, y + (k - (lines.length - 1) / 2) * pixels * 1.2, colours.ink));
  };

  const inTwo = (text) => {
    const gaps = [...text.matchAll(/ /g)].map((gap) => gap.index);
    if (!gaps.length) return [text];
    const half = text.length / 2;
    const at = gaps.reduce((best, gap) => (Math.abs(gap - half) < Math.abs(best - half) ? gap : best));
    return [text.slice(0, at), text.slice(at + 1)];
  };

  const noData = (place) => {
    font(place.phone ? 40 : 56);
    words(style.words.noData, place.middle, place.height / 2 - (place.phone ? 14 : 10), "#ffffff");
    font(place.phone ? 15 : 18, 500);
    words(style.words.noAnswer, place.middle, place.height / 2 + (place.phone ? 24 : 34), "#ffffff");
  };

  /** Draws one state; gives what a test or a screen reader may want to know of the picture. */
  const draw = (state, message, reason) => {
    const place = layout();
    pen.clearRect(0, 0, place.width, place.height);
    if (state === "silent") {
      noData(place);
    } else if (state === "guide") {
      lamps(place, message.k, message.m !== undefined);
      number(place, message);
      prediction(place, message);
      labels(place);
    } else {
      hollow(place, reason);
      labels(place);
    }
    if (state !== "guide") return { state, lamps: null, number: null, steer: null, prediction: null, reason };
    return {
      state,
      lamps: message.k,
      number: message.d,
      steer: ["left", "none", "right"][steerTo(message) + 1],
      prediction: message.p === undefined ? null : message.p / 1000,
      reason: null,
    };
  };

  return { fit, draw };
}
