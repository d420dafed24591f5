// What the page needs as a whole: it reconnects when it is seen, stays awake, sounds, and starts anew when the picture is
// lost. Runs before viser's own script.
"use strict";

(() => {
  // viser looks for its server only while the document has the focus; a console is in use whenever it is seen.
  document.hasFocus = () => !document.hidden;

  document.addEventListener("DOMContentLoaded", () => {
    document.title = "Guidance";
  });

  // --- awake: browsers allow this over https and on this machine, and give it back when the page was hidden ---
  const stayAwake = () => {
    if (document.visibilityState === "visible" && navigator.wakeLock) {
      navigator.wakeLock.request("screen").catch(() => {}); // refused on a low battery
    }
  };
  document.addEventListener("visibilitychange", stayAwake);
  addEventListener("pointerdown", stayAwake, { once: true });

  // --- sound: browsers allow it after the first tap ---
  let audio = null;
  const allowSound = () => {
    audio ??= new AudioContext();
    audio.resume();
  };
  addEventListener("pointerdown", allowSound, { once: true, capture: true });

  const beep = (hertz, milliseconds, delay = 0) => {
    if (!audio || audio.state !== "running") return false;
    const from = audio.currentTime + delay / 1000;
    const until = from + milliseconds / 1000;
    const tone = audio.createOscillator();
    const loudness = audio.createGain();
    tone.frequency.value = hertz;
    loudness.gain.setValueAtTime(0, from);
    loudness.gain.linearRampToValueAtTime(0.3, from + 0.01);
    loudness.gain.setValueAtTime(0.3, until - 0.02);
    loudness.gain.linearRampToValueAtTime(0, until);
    tone.connect(loudness).connect(audio.destination);
    tone.start(from);
    tone.stop(until);
    return true;
  };

  // --- a lost graphics context leaves viser's canvas black for good ---
  addEventListener("webglcontextlost", () => setTimeout(() => location.reload(), 1500), true);

  // --- day or night is whatever viser's theme says ---
  const heardNight = [];
  const isNight = () => document.documentElement.getAttribute("data-mantine-color-scheme") === "dark";
  new MutationObserver(() => heardNight.forEach((hear) => hear(isNight()))).observe(document.documentElement, {
    attributes: true,
    attributeFilter: ["data-mantine-color-scheme"],
  });
  const onNight = (hear) => {
    heardNight.push(hear);
    hear(isNight());
  };

  // --- on a phone viser's panels are a sheet over the picture: the picture ends where the sheet begins ---
  let sheet = null;
  let picture = null;
  const fit = () => {
    if (picture) picture.style.height = sheet ? `calc(100% - ${sheet.offsetHeight}px)` : "";
  };
  const sized = new ResizeObserver(fit);
  const isSheet = (one) => {
    const style = getComputedStyle(one);
    return style.position === "fixed" && style.bottom === "0px" && style.maxHeight !== "none";
  };
  const look = () => {
    if (sheet?.isConnected && picture?.isConnected) return;
    sized.disconnect();
    sheet = [...document.querySelectorAll("#root .mantine-Paper-root")].find(isSheet) ?? null;
    picture = document.querySelector("#root canvas[data-engine]");
    while (picture && getComputedStyle(picture).position !== "absolute") picture = picture.parentElement;
    if (sheet) sized.observe(sheet);
    fit();
  };
  new MutationObserver(look).observe(document.documentElement, { childList: true, subtree: true });

  // What the page says, in the driver's language: the light bar hears it from the console.
  const words = { notSent: "{file} could not be sent" };

  window.__page = { beep, isNight, onNight, words };
})();
