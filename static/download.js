// Links to files that are made when they are asked for: while one is made the link says so, and what went wrong too.
"use strict";

(() => {
  const say = (link, words) => {
    link.querySelector(".g-file-said")?.remove();
    if (!words) return;
    const said = document.createElement("span");
    said.className = "g-file-said";
    said.textContent = words;
    link.append(said);
  };

  const named = (answer) => {
    const name = /filename\*=UTF-8''([^;]+)/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1];
    return name ? decodeURIComponent(name) : "file";
  };

  const store = (content, name) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(content);
    link.download = name;
    link.hidden = true;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  };

  addEventListener("click", async (event) => {
    const link = event.target.closest?.("a[data-making]");
    if (!link) return;
    event.preventDefault();
    if (link.dataset.busy) return;
    link.dataset.busy = "1";
    say(link, link.dataset.making);
    try {
      const answer = await fetch(link.href);
      if (answer.ok) {
        store(await answer.blob(), named(answer));
        say(link, "");
      } else {
        say(link, await answer.text());
      }
    } catch {
      say(link, link.dataset.failed);
    }
    delete link.dataset.busy;
  });
})();
