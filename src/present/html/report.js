"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const charts = (name) => [...document.querySelectorAll(`svg.${name}`)];  // for wide and for narrow screens
  // Axes are from, to, begin and end: values at units of the SVG.
  const axis = (svg, side) => svg.dataset[side].split(" ").map(Number);
  const pixel = ([from, to, begin, end], value) => begin + (value - from) / (to - from) * (end - begin);
  const set = (element, values) => { for (const [key, value] of Object.entries(values)) element.setAttribute(key, value); };
  // The position of the pointer on the axes of a chart.
  const place = (event, svg) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const value = ([from, to, begin, end], unit) => from + (unit - begin) / (end - begin) * (to - from);
    return [value(axis(svg, "x"), at.x), value(axis(svg, "y"), at.y)];
  };
  // The sequence and the frame at a position of an axis; undefined outside.
  const frameAt = (bands, position) => {
    const band = bands.find((one) => position >= one.at && position < one.at + one.count);
    return band && [band.sequence, band.first + Math.floor(position) - band.at];
  };

  // The outcome of one query.
  const unmatched = "the ground truth has no match";
  const verdicts = { c: "correct", w: "incorrect", i: "ignored", u: "not recognized",
    W: `incorrect: ${unmatched}`, I: `ignored: ${unmatched}`, U: unmatched };
  const slider = byId("at");
  const count = data.best.length;
  const { words, divisor } = data.unit;
  const describe = (i) => {
    const match = data.matches[i];
    const parts = [];
    if (match) parts.push(`best match ${data.sequences[match[0]]} ${match[1]}`, `${words} ${Number((data.scores[i] / divisor).toPrecision(4))}`);
    else parts.push("no best match");
    if (data.judged) parts.push(verdicts[data.best[i]]);
    const off = data.off?.[i];
    if (off) parts.push(`${Math.abs(off)} frame${Math.abs(off) === 1 ? "" : "s"} ${off > 0 ? "ahead of" : "behind"} the ground truth`);
    if (match) parts.push(data.recognized[i] === "." ? "not recognized" : "recognized");
    if (data.ranks && data.ranks[i]) parts.push(`the first correct reference has rank ${data.ranks[i]}`);
    return `Frame ${i}: ${parts.join(", ")}.`;
  };
  // Images of evenly spaced frames, by "query frame" and "sequence frame", and of their best matches.
  const images = data.images;
  const pictured = [...Array(count).keys()].filter((i) => images[`query ${i}`]);
  const picture = (figure, words, found) => {
    figure.firstElementChild.textContent = found ? `${words}: ${found[1]}` : words;
    const image = figure.querySelector("img");
    if (found?.[0]) set(image ?? figure.appendChild(document.createElement("img")), { src: found[0], alt: words });
    else image?.remove();
  };
  // Lines between the local features of both images that agree.
  const overlay = byId("pair").querySelector("svg");
  let agreeing = [];
  const drawLines = () => {
    const drawn = byId("lines").querySelector("input").checked ? agreeing : [];
    const [query, best] = [...byId("pair").querySelectorAll("img")].map(({ offsetLeft, offsetTop, offsetWidth, offsetHeight }) =>
      (x, y) => [offsetLeft, offsetTop].map((start, k) => start + [x, y][k] * Math.max(offsetWidth, offsetHeight)));
    overlay.replaceChildren(...drawn.map(([a, b, c, d]) => {
      const line = document.createElementNS(overlay.namespaceURI, "line");
      const [[x1, y1], [x2, y2]] = [query(a, b), best(c, d)];
      set(line, { x1, y1, x2, y2 });
      return line;
    }));
  };
  byId("lines").addEventListener("change", drawLines);
  new ResizeObserver(drawLines).observe(byId("pair"));
  const show = (i) => {
    const near = pictured.reduce((best, one) => (Math.abs(one - i) < Math.abs(best - i) ? one : best));
    const match = data.matches[near];
    const [query, best] = byId("pair").children;
    picture(query, `${near === i ? "" : "nearest frame with an image: "}query ${near}`, images[`query ${near}`]);
    picture(best, match ? `best match ${data.sequences[match[0]]} ${match[1]}` : "no best match",
      match && images[`${match[0]} ${match[1]}`]);
    byId("pair").hidden = false;
    agreeing = data.inliers?.[near] ?? [];
    byId("lines").hidden = !data.inliers;
    byId("lines").querySelector("span").textContent = `${agreeing.length} local features of both images agree`;
    drawLines();
  };
  const say = () => {
    byId("said").textContent = describe(Number(slider.value));
    if (pictured.length) show(Number(slider.value));
    for (const here of document.querySelectorAll(".here")) {
      const x = pixel(axis(here.ownerSVGElement, "x"), Number(slider.value) + 0.5);
      set(here, { x1: x, x2: x, visibility: "visible" });
    }
  };
  const go = (i) => {
    slider.value = Math.max(0, Math.min(count - 1, i));
    say();
  };
  if (count) {
    byId("inspector").hidden = false;
    slider.max = count - 1;
    slider.addEventListener("input", say);
    for (const svg of [...charts("timeline"), ...charts("frames-off"), ...charts("margins")])
      svg.addEventListener("click", (event) => go(Math.floor(place(event, svg)[0])));
    say();
  }
  for (const svg of charts("matrix"))
    svg.addEventListener("pointermove", (event) => {
      const [x, y] = place(event, svg);
      const [column, row] = [frameAt(data.columns, x), frameAt(data.rows, y)];
      if (column && row) byId("cell").textContent = `Query frame ${row[1]}, ${data.sequences[column[0]]} ${column[1]}.`;
    });
  window.page = { data, count, charts, axis, pixel, set, place, frameAt, go, at: () => Number(slider.value) };

  // The slider selects a threshold, the strictest first. It starts at the margin of the decision,
  // or at the loosest threshold without a mistake.
  if (!data.steps.length) return;
  const threshold = byId("threshold");
  const draw = (svg, name) => {
    const element = svg.appendChild(document.createElementNS(svg.namespaceURI, name));
    element.setAttribute("class", "cut");
    return [svg, element];
  };
  const lines = charts("thresholds").map((svg) => draw(svg, "line"));
  const rings = charts("precision-recall").map((svg) => draw(svg, "circle"));
  const accept = () => {
    const [value, right, wrong, unjudged] = data.steps[Number(threshold.value)];
    const precision = right + wrong ? right / (right + wrong) : 1;
    const recall = data.positives ? right / data.positives : 0;
    const limit = Number(value.toPrecision(6));
    const counts = data.judged ? [`${right} correct`, `${wrong} incorrect`] : [];
    if (unjudged || !data.judged) counts.push(`${unjudged} not judged`);
    const rates = data.judged ? `; precision ${(100 * precision).toFixed(1)} %, recall ${(100 * recall).toFixed(1)} %` : "";
    byId("accepted").textContent = `${data.order === "distance" ? `Up to ${limit}` : `From ${limit} on`}: ${counts.join(", ")}${rates}.`;
    for (const [svg, line] of lines) {
      const x = pixel(axis(svg, "x"), value), [, , bottom, top] = axis(svg, "y");
      set(line, { x1: x, x2: x, y1: bottom, y2: top });
    }
    for (const [svg, ring] of rings)
      set(ring, { cx: pixel(axis(svg, "x"), recall), cy: pixel(axis(svg, "y"), precision), r: 6 });
  };
  threshold.max = data.steps.length - 1;
  const clean = data.steps.filter((step) => step[2] === 0).length;
  const asked = data.steps.filter((step) => step[0] >= data.asked).length;
  threshold.value = (data.asked !== null ? asked || 1 : data.judged && clean ? clean : data.steps.length) - 1;
  threshold.addEventListener("input", accept);
  byId("cut").hidden = false;
  accept();
})();
