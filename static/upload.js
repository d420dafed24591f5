// Files chosen in a panel: sent as they are to where the panel awaits them. What went wrong is said where the button is.
"use strict";

(() => {
  const say = (label, words) => {
    label.querySelector(".g-file-said")?.remove();
    if (!words) return;
    const said = document.createElement("span");
    said.className = "g-file-said";
    said.textContent = words;
    label.append(said);
  };

  addEventListener("change", async (event) => {
    const input = event.target;
    const token = input?.dataset?.upload;
    const file = token && input.files?.[0];
    if (!file) return;
    const label = input.closest("label");
    say(label, `${file.name} …`);
    try {
      const answer = await fetch(`/upload/${encodeURIComponent(token)}`, {
        method: "POST",
        headers: { "X-File-Name": encodeURIComponent(file.name), "Content-Type": "application/octet-stream" },
        body: file,
      });
      say(label, await answer.text());
    } catch {
      say(label, __page.words.notSent.replace("{file}", () => file.name));
    }
    input.value = "";
  });
})();
