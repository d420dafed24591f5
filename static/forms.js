// The keyboard that fits what is typed. A number that may be negative gets the whole one: some have no minus otherwise.
// A list is chosen from, not searched: it brings no keyboard up. A secret is neither learnt nor corrected.
"use strict";

const fit = ({ target: input }) => {
  if (!(input instanceof HTMLInputElement)) return;
  if (input.closest(".mantine-Select-root, .mantine-Select-wrapper") || input.getAttribute("aria-haspopup") === "listbox") {
    input.inputMode = "none";
    return;
  }
  let row = input.closest(".mantine-TextInput-root");
  while (row && !row.nextElementSibling) row = row.parentElement;
  for (let next = row?.nextElementSibling, steps = 0; next && steps < 2; next = next.nextElementSibling, steps += 1) {
    const hint = next.querySelector("[data-keys]");
    if (!hint) continue;
    const secret = hint.dataset.keys === "secret";
    if (secret) {
      input.autocomplete = "off";
      input.autocapitalize = "none";
      input.spellcheck = false;
    }
    input.inputMode = secret ? "text" : hint.dataset.keys;
    return;
  }
};
for (const coming of ["pointerdown", "focusin"]) addEventListener(coming, fit, true);

// A picture beside buttons is pressed as the button of its words.
addEventListener("click", (event) => {
  const card = event.target instanceof Element && event.target.closest("[data-press]");
  if (!card) return;
  for (const button of document.querySelectorAll("button")) {
    if (button.textContent.replace(/^● /, "") === card.dataset.press) {
      button.click();
      return;
    }
  }
});
