// Fingers. Three things that viser 1.1.1 does not do for a shaking cab:
// taps on the ground arrive (it takes the implicit capture of a touch for a drag of its own), a finger may wander 14 px
// and still tap (there: 3 px), and its panels stay where they are, whatever drags at their heads. Orbit, pinch and
// dragging of markers are as they were.
"use strict";

(() => {
  const SLOP = 14;
  const PANEL_HEADS = "[data-dock-strip], [data-dock-region-handle], [data-dock-griphandle]";
  const resting = new Map();
  const onHead = new Set();

  addEventListener(
    "pointerdown",
    (event) => {
      if (event.target.closest?.(PANEL_HEADS)) onHead.add(event.pointerId);
      if (event.pointerType === "mouse" || event.target.tagName !== "CANVAS") return;
      if (event.target.hasPointerCapture(event.pointerId)) event.target.releasePointerCapture(event.pointerId);
      resting.set(event.pointerId, { x: event.clientX, y: event.clientY });
    },
    true,
  );

  addEventListener(
    "pointermove",
    (event) => {
      if (onHead.has(event.pointerId)) event.stopImmediatePropagation();
      const start = resting.get(event.pointerId);
      if (!start) return;
      const moved = Math.hypot(event.clientX - start.x, event.clientY - start.y);
      if (resting.size === 1 && moved < SLOP) event.stopImmediatePropagation();
      else resting.delete(event.pointerId);
    },
    true,
  );

  for (const end of ["pointerup", "pointercancel"]) {
    addEventListener(
      end,
      (event) => {
        resting.delete(event.pointerId);
        onHead.delete(event.pointerId);
      },
      true,
    );
  }
})();
