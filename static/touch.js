// Taps on the ground by finger. viser 1.1.1 overlooks them: it takes the implicit capture of a touch for a drag of its
// own, and lets a finger wander 3 px at most. Here the capture is given back, and movement below 14 px is not told to
// viser. Orbit, pinch and dragging of markers stay as they are.
"use strict";

(() => {
  const SLOP = 14;
  const resting = new Map();

  addEventListener(
    "pointerdown",
    (event) => {
      if (event.pointerType === "mouse" || event.target.tagName !== "CANVAS") return;
      if (event.target.hasPointerCapture(event.pointerId)) event.target.releasePointerCapture(event.pointerId);
      resting.set(event.pointerId, { x: event.clientX, y: event.clientY });
    },
    true,
  );

  addEventListener(
    "pointermove",
    (event) => {
      const start = resting.get(event.pointerId);
      if (!start) return;
      const moved = Math.hypot(event.clientX - start.x, event.clientY - start.y);
      if (resting.size === 1 && moved < SLOP) event.stopImmediatePropagation();
      else resting.delete(event.pointerId);
    },
    true,
  );

  for (const end of ["pointerup", "pointercancel"]) {
    addEventListener(end, (event) => resting.delete(event.pointerId), true);
  }
})();
