// Anchors on the chart of best matches, and a list of disagreements, saved as files.
(() => {
  const { data, count, charts, at, go, axis, pixel, set, place, frameAt } = window.page;
  const byId = (id) => document.getElementById(id);
  let isSaved = true;
  let anchors = [];  // [query frame, sequence, frame]
  const several = data.sequences.length > 1;

  const field = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  // Files have frames of recordings, of which sequences may select some.
  const recorded = (sources, frame) => (sources ? sources[frame] : frame);
  const row = (query, sequence, reference, ...more) =>
    [recorded(data.query_sources, query), ...(several ? [field(data.sequences[sequence])] : []),
      recorded(data.train_sources?.[sequence], reference), ...more].join(",");
  const header = several ? "query,sequence,reference" : "query,reference";
  const file = (lines) => lines.join("\n") + "\n";
  const sorted = () => [...anchors].sort((a, b) => a[1] - b[1] || a[0] - b[0]);
  const isWrong = (i) => data.matches[i] && "wW".includes(data.best[i]);
  const disagreements = () => {
    const lines = [`${header},score,recognized,ground_truth`];
    for (let i = 0; i < count; ++i)
      if (isWrong(i))
        lines.push(row(i, ...data.matches[i], data.scores[i], data.recognized[i] === "." ? "no" : "yes",
          data.best[i] === "W" ? "no match" : "different"));
    return file(lines);
  };
  const save = (name, text) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };

  const block = byId("anchors");
  const timelines = charts("timeline");
  const make = (name) => document.createElementNS(timelines[0].namespaceURI, name);
  const layers = timelines.map((svg) => svg.appendChild(make("g")));
  const positionOf = (bands, sequence, frame) => {
    const band = bands.find((one) => one.sequence === sequence && frame >= one.first && frame < one.first + one.count);
    return band && band.at + frame - band.first + 0.5;
  };
  const refresh = () => {
    layers.forEach((layer, i) => layer.replaceChildren(...anchors.map(([query, sequence, frame]) => {
      const circle = make("circle");
      set(circle, { class: "anchor", r: 6, cx: pixel(axis(timelines[i], "x"), query + 0.5),
        cy: pixel(axis(timelines[i], "y"), positionOf(data.train, sequence, frame)) });
      return circle;
    })));
    byId("anchored").textContent = `${anchors.length} anchor${anchors.length === 1 ? "" : "s"}.`;
    byId("save-anchors").disabled = anchors.length === 0;
  };
  // A query frame has at most one anchor per sequence.
  const anchor = (query, sequence, frame) => {
    isSaved = false;
    anchors = [...anchors.filter((one) => one[0] !== query || one[1] !== sequence), [query, sequence, frame]];
    refresh();
  };
  timelines.forEach((svg, m) => svg.addEventListener("click", (event) => {
    if (!block.open) return;
    const near = anchors.findIndex((one, i) => {
      const box = layers[m].children[i].getBoundingClientRect();
      return event.clientX >= box.left - 2 && event.clientX <= box.right + 2 && event.clientY >= box.top - 2 && event.clientY <= box.bottom + 2;
    });
    if (near >= 0) {
      anchors.splice(near, 1);
      return refresh();
    }
    const [x, y] = place(event, svg);
    const found = frameAt(data.train, y);
    if (found && x >= 0 && x < count) anchor(Math.floor(x), ...found);
  }));

  const nextWrong = () => {
    for (let step = 1; step <= count; ++step)
      if (isWrong((at() + step) % count)) return go((at() + step) % count);
  };
  const press = (key) => {
    const i = at();
    if (key === "a" && data.matches[i]) anchor(i, ...data.matches[i]);
    else if (key === "j" || key === "k") go(at() + (key === "j" ? 1 : -1));
    else if (key === "n" && data.judged) nextWrong();
  };
  if (!count) return;
  document.addEventListener("keydown", (event) => {
    if (!block.open || event.ctrlKey || event.metaKey || event.altKey) return;
    press(event.key);
  });
  for (const button of document.querySelectorAll("#tools [data-key]"))
    button.addEventListener("click", () => press(button.dataset.key));
  byId("save-anchors").addEventListener("click", () => {
    isSaved = true;
    save("anchors.csv", file([header.replace("reference", "anchor"), ...sorted().map((one) => row(...one))]));
  });
  window.addEventListener("beforeunload", (event) => { if (!isSaved) event.preventDefault(); });
  byId("next-disagreement")?.addEventListener("click", () => press("n"));
  byId("save-disagreements")?.addEventListener("click", () => save("disagreements.csv", disagreements()));
  byId("tools").hidden = false;
  refresh();
})();
