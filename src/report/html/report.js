"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);

  // The gallery's filter.
  const cards = [...document.querySelectorAll(".card")];
  const filter = byId("filter");
  const visible = () => cards.filter((card) => !card.hidden);
  const show = () => {
    const kind = filter.elements.kind.value;
    const words = byId("words").value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const card of cards) {
      const text = card.textContent.toLowerCase();
      card.hidden = (kind !== "all" && card.dataset.kind !== kind) || !words.every((word) => text.includes(word));
    }
    byId("shown").textContent = `${visible().length} of ${cards.length}`;
  };
  if (cards.length) {
    filter.hidden = false;
    filter.addEventListener("input", show);
    filter.addEventListener("submit", (event) => event.preventDefault());
    show();
  }
  const onField = (target) => target.matches("input[type=search], input[type=range], input[type=radio], summary");
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "/" && !onField(event.target) && cards.length) {
      event.preventDefault();
      byId("words").focus();
    }
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const at = visible().indexOf(event.target);
    if (step && at >= 0) {
      event.preventDefault();
      visible()[Math.max(0, Math.min(visible().length - 1, at + step))].focus();
    }
  });

  // What became of one query.
  const verdicts = { c: "right", w: "wrong", n: "wrong: the ground truth has no match", i: "ignored", u: "unreadable" };
  const slider = byId("at");
  const count = data.best.length;
  const here = byId("here");
  const say = () => {
    const i = Number(slider.value);
    const frame = data.first_frame + i;
    const match = data.matches[i];
    const parts = [];
    if (match) parts.push(`best match ${data.sequences[match[0]]} ${match[1]}`, `${data.kind} ${data.scores[i]}`);
    else if (data.best[i] !== "u") parts.push("nothing found");
    if (data.judged || data.best[i] === "u") parts.push(verdicts[data.best[i]]);
    if (match) parts.push(data.recognised[frame] === "." ? "not recognised" : "recognised");
    if (data.ranks && data.ranks[i]) parts.push(`the first right reference has rank ${data.ranks[i]}`);
    byId("said").textContent = `Frame ${frame}: ${parts.join(", ")}.`;
    if (here) {
      const x = data.left + data.width * (frame + 0.5) / data.frames;
      here.setAttribute("x1", x);
      here.setAttribute("x2", x);
      here.removeAttribute("visibility");
    }
  };
  if (count) {
    byId("inspector").hidden = false;
    slider.max = count - 1;
    slider.addEventListener("input", say);
    say();
    document.querySelector("svg.timeline")?.addEventListener("click", (event) => {
      const box = event.currentTarget.getBoundingClientRect();
      const x = (event.clientX - box.left) / box.width * data.svg_width;
      const frame = Math.floor((x - data.left) / data.width * data.frames);
      slider.value = Math.max(0, Math.min(count - 1, frame - data.first_frame));
      say();
    });
  }
})();
