// Labels of best matches and anchors on the matrix, saved as files.
(() => {
  const { data, count, charts, at, go, axis, pixel, set, place, frameAt } = window.page;
  const byId = (id) => document.getElementById(id);
  const words = { s: "same", d: "different", i: "ignore" };
  const labels = new Map();  // by query
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
  // Best matches without a label are written as ignore; pairs without a line are different.
  const pairs = () => {
    const lines = [`${header},label`];
    for (let i = 0; i < count; ++i) {
      const label = labels.get(i) ?? "ignore";
      if (data.matches[i] && label !== "different") lines.push(row(i, ...data.matches[i], label));
    }
    return file(lines);
  };
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

  const block = byId("labels");
  const matrices = charts("matrix");
  const make = (name) => document.createElementNS(matrices[0].namespaceURI, name);
  const layers = matrices.map((svg) => svg.appendChild(make("g")));
  const positionOf = (bands, sequence, frame) => {
    const band = bands.find((one) => one.sequence === sequence && frame >= one.first && frame < one.first + one.count);
    return band && band.at + frame - band.first + 0.5;
  };
  const refresh = () => {
    layers.forEach((layer, i) => layer.replaceChildren(...anchors.map(([query, sequence, frame]) => {
      const circle = make("circle");
      set(circle, { class: "anchor", r: 6, cx: pixel(axis(matrices[i], "x"), positionOf(data.columns, sequence, frame)),
        cy: pixel(axis(matrices[i], "y"), positionOf(data.rows, 0, query)) });
      return circle;
    })));
    for (const card of document.querySelectorAll(".card")) {
      const label = labels.get(Number(card.dataset.at));
      if (label) card.dataset.label = label;
      else delete card.dataset.label;
    }
    const here = labels.get(at());
    const of = (word) => [...labels.values()].filter((label) => label === word).length;
    byId("labeled").textContent = `Frame ${at()}: ${here ?? "not labeled"}. `
      + `${of("same")} same, ${of("different")} different, ${of("ignore")} ignored, ${anchors.length} anchor${anchors.length === 1 ? "" : "s"}.`;
  };
  // A query frame has at most one anchor per sequence.
  const anchor = (query, sequence, frame) => {
    anchors = [...anchors.filter((one) => one[0] !== query || one[1] !== sequence), [query, sequence, frame]];
    refresh();
  };
  matrices.forEach((svg, m) => svg.addEventListener("click", (event) => {
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
    const column = frameAt(data.columns, x);
    const line = frameAt(data.rows, y);
    if (column && line) anchor(line[1], ...column);
  }));

  const nextWrong = () => {
    for (let step = 1; step <= count; ++step)
      if (isWrong((at() + step) % count)) return go((at() + step) % count);
  };
  // The query of the focused card, or the selected query.
  const chosen = (target) => Number(target.closest?.(".card")?.dataset.at ?? at());
  const press = (key, target) => {
    const i = chosen(target);
    if (words[key] && data.matches[i]) labels.set(i, words[key]);
    else if (key === "u") labels.delete(i);
    else if (key === "a" && data.matches[i]) anchor(i, ...data.matches[i]);
    else if (key === "j" || key === "k") go(at() + (key === "j" ? 1 : -1));
    else if (key === "n" && data.judged) nextWrong();
    else return;
    refresh();
  };
  if (!count) return;
  document.addEventListener("keydown", (event) => {
    if (!block.open || event.ctrlKey || event.metaKey || event.altKey) return;
    press(event.key, event.target);
  });
  for (const button of document.querySelectorAll("#tools [data-key]"))
    button.addEventListener("click", () => press(button.dataset.key, document.body));
  byId("at").addEventListener("input", refresh);
  byId("save-pairs").addEventListener("click", () => save("pairs.csv", pairs()));
  byId("save-anchors").addEventListener("click", () =>
    save("anchors.csv", file([header, ...sorted().map((one) => row(...one))])));
  byId("next-disagreement")?.addEventListener("click", () => press("n", document.body));
  byId("save-disagreements")?.addEventListener("click", () => save("disagreements.csv", disagreements()));
  byId("tools").hidden = false;
  refresh();
})();
