// What pages do without: nothing here is needed, it only saves waiting and clicking.
"use strict";

// A matrix with cases in progress is looked at again until none is; the rest of the page stays as it is.
const PAUSE = 1500;

async function again() {
  const live = document.getElementById("live");
  if (!live || live.dataset.live !== "yes") return;
  try {
    const answer = await fetch(location.href, { headers: { Accept: "text/html" } });
    if (answer.ok) {
      const page = new DOMParser().parseFromString(await answer.text(), "text/html");
      const fresh = page.getElementById("live");
      if (fresh && fresh.innerHTML !== live.innerHTML) {
        const focused = document.activeElement;
        const value = live.contains(focused) ? focused.getAttribute("value") : null;
        const cell = live.contains(focused) ? focused.closest("[id]") : null;
        live.replaceWith(fresh);
        const back = value && [...fresh.querySelectorAll("button")].find((each) => each.value === value);
        const near = cell && document.getElementById(cell.id);
        (back || (near && near.querySelector("a, button")))?.focus();
      }
    }
  } catch {
    // The service is away for a moment: asked again after the same pause.
  }
  setTimeout(again, PAUSE);
}

// One press is enough, and is seen to be.
addEventListener("submit", (event) => {
  const button = event.submitter;
  if (!button || event.target.method !== "post") return;
  button.setAttribute("aria-busy", "true");
});
addEventListener("pageshow", () => {
  document.querySelectorAll("[aria-busy]").forEach((each) => each.removeAttribute("aria-busy"));
});

const query = document.getElementById("query");
query?.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) query.form.requestSubmit();
});

setTimeout(again, PAUSE);
