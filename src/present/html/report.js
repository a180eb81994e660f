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

  // The outcome of one query.
  const verdicts = { c: "correct", w: "incorrect", n: "incorrect: the ground truth has no match", i: "ignored", u: "unreadable" };
  const slider = byId("at");
  const count = data.best.length;
  const here = byId("here");
  const describe = (i) => {
    const frame = data.first_frame + i;
    const match = data.matches[i];
    const parts = [];
    if (match) parts.push(`best match ${data.sequences[match[0]]} ${match[1]}`, `${data.kind} ${data.scores[i]}`);
    else if (data.best[i] !== "u") parts.push("nothing found");
    if (data.judged || data.best[i] === "u") parts.push(verdicts[data.best[i]]);
    if (match) parts.push(data.recognized[frame] === "." ? "not recognized" : "recognized");
    if (data.ranks && data.ranks[i]) parts.push(`the first correct reference has rank ${data.ranks[i]}`);
    return `Frame ${frame}: ${parts.join(", ")}.`;
  };
  const say = () => {
    const frame = data.first_frame + Number(slider.value);
    byId("said").textContent = describe(Number(slider.value));
    if (here) {
      const [from, to, begin, end] = data.areas.timeline.x;
      const x = begin + (end - begin) * (frame + 0.5 - from) / (to - from);
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
  }
  // The interface for the other scripts.
  window.page = {
    data, count, describe,
    at: () => Number(slider.value),
    go: (i) => {
      slider.value = Math.max(0, Math.min(count - 1, i));
      say();
    },
    // The position of the pointer on the axes of a chart.
    place: (event, svg, area) => {
      const box = svg.getBoundingClientRect();
      const unit = area.width / box.width;
      const value = ([from, to, begin, end], at) => from + (at - begin) / (end - begin) * (to - from);
      return [value(area.x, (event.clientX - box.left) * unit), value(area.y, (event.clientY - box.top) * unit)];
    },
    // The sequence and the frame at a position of an axis; undefined outside.
    frameAt: (bands, position) => {
      const band = bands.find((one) => position >= one.at && position < one.at + one.count);
      return band && [band.sequence, band.first + Math.floor(position) - band.at];
    },
  };
  document.querySelector("svg.timeline")?.addEventListener("click", (event) => {
    const [x] = window.page.place(event, event.currentTarget, data.areas.timeline);
    if (count) window.page.go(Math.floor(x) - data.first_frame);
  });
})();
