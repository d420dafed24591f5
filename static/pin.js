// The keypad of the PIN page. Without it the page still works, with the tablet's own keyboard.
"use strict";

(() => {
  const form = document.querySelector("form");
  const field = form.elements.pin;
  const keys = form.querySelector(".keys");
  const message = document.querySelector(".message");
  const DIGITS = 6;

  const send = () => {
    document.body.classList.add("waiting");
    form.submit();
  };

  const type = (digit) => {
    if (field.value.length < DIGITS) field.value += digit;
    if (field.value.length === DIGITS) send();
  };

  const key = (label, name, act) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.setAttribute("aria-label", name);
    if (Number.isNaN(Number(label))) button.className = "word";
    button.addEventListener("click", act);
    keys.append(button);
  };

  for (const digit of "123456789") key(digit, digit, () => type(digit));
  key(keys.dataset.clear, keys.dataset.clear, () => (field.value = ""));
  key("0", "0", () => type("0"));
  key(keys.dataset.back, keys.dataset.delete, () => (field.value = field.value.slice(0, -1)));
  keys.hidden = false;
  form.querySelector(".enter").hidden = true;
  field.inputMode = "none"; // our keys are larger than the tablet's
  field.addEventListener("input", () => {
    field.value = field.value.replace(/[^0-9]/g, "").slice(0, DIGITS);
    if (field.value.length === DIGITS) send();
  });
  field.focus();

  // Too many wrong ones: count down, then try again.
  const words = message.textContent;
  let wait = Number(message.dataset.wait);
  const countDown = () => {
    document.body.classList.toggle("waiting", wait > 0);
    message.textContent = wait > 0 ? `${words} ${message.dataset.waiting.replace("{seconds}", wait)}` : "";
    if (wait > 0) setTimeout(countDown, 1000);
    wait -= 1;
  };
  if (wait > 0) countDown();
})();
