// Values at the pointer, and best matches by threshold.
(() => {
  const { data, count, describe, place, frameAt } = window.page;
  const byId = (id) => document.getElementById(id);
  const draw = (svg, name, kind) => {
    const element = document.createElementNS(svg.namespaceURI, name);
    element.setAttribute("class", kind);
    svg.append(element);
    return element;
  };

  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  document.body.append(tip);
  const show = (event, text) => {
    tip.hidden = !text;
    if (!text) return;
    tip.textContent = text;
    const left = Math.min(event.clientX + 14, document.documentElement.clientWidth - tip.offsetWidth - 4);
    tip.style.left = `${Math.max(4, left)}px`;
    tip.style.top = `${event.clientY + 16}px`;
  };
  const nearest = (points, value, side) => points.reduce((best, point) =>
    best === null || Math.abs(point[side] - value) < Math.abs(best[side] - value) ? point : best, null);
  const number = (value) => String(Number(value.toPrecision(6)));
  const counted = (right, wrong, unjudged) => data.judged
    ? `${right} correct, ${wrong} incorrect${unjudged ? `, ${unjudged} not judged` : ""}` : `${unjudged} not judged`;
  const limit = (value) => data.order === "distance" ? `Up to ${number(value)}` : `From ${number(value)} on`;
  const texts = {
    timeline: (x, y) => {
      const i = Math.floor(x) - data.first_frame;
      const at = frameAt(data.frames, y);
      const here = at ? ` Here: ${data.sequences[at[0]]} ${at[1]}.` : "";
      return i >= 0 && i < count ? describe(i) + here : "";
    },
    matrix: (x, y) => {
      const column = frameAt(data.columns, x);
      const row = frameAt(data.rows, y);
      return column && row ? `query frame ${row[1]}, ${data.sequences[column[0]]} ${column[1]}` : "";
    },
    thresholds: (x) => {
      const step = nearest(data.steps, x, 0);
      return step ? `${limit(step[0])}: ${counted(step[1], step[2], step[3])}` : "";
    },
    "precision-recall": (x) => {
      const point = nearest(data.curve, x, 0);
      return point ? `recall ${point[0].toFixed(3)}, precision ${point[1].toFixed(3)}` : "";
    },
  };
  for (const [name, text] of Object.entries(texts)) {
    const svg = document.querySelector(`svg.${name}`);
    svg?.addEventListener("pointermove", (event) => show(event, text(...place(event, svg, data.areas[name]))));
    svg?.addEventListener("pointerleave", () => show(null, ""));
  }

  // The slider selects a threshold, the strictest first. It starts at the margin of the decision,
  // or at the loosest threshold without a mistake.
  if (!data.steps.length) return;
  const slider = byId("threshold");
  const pixel = ([from, to, begin, end], value) => begin + (value - from) / (to - from) * (end - begin);
  const chart = document.querySelector("svg.thresholds");
  const curve = document.querySelector("svg.precision-recall");
  const line = chart && draw(chart, "line", "cut");
  const ring = curve && data.judged && draw(curve, "circle", "cut");
  const accept = () => {
    const [threshold, right, wrong, unjudged] = data.steps[Number(slider.value)];
    const precision = right + wrong ? right / (right + wrong) : 1;
    const recall = data.to_find ? right / data.to_find : 0;
    const rates = data.judged ? `; precision ${(100 * precision).toFixed(1)} %, recall ${(100 * recall).toFixed(1)} %` : "";
    byId("accepted").textContent = `${limit(threshold)}: ${counted(right, wrong, unjudged)}${rates}.`;
    const [x, y] = [data.areas.thresholds.x, data.areas.thresholds.y];
    if (line) for (const [key, value] of [["x1", pixel(x, threshold)], ["x2", pixel(x, threshold)], ["y1", y[2]], ["y2", y[3]]]) line.setAttribute(key, value);
    const area = data.areas["precision-recall"];
    if (ring) for (const [key, value] of [["cx", pixel(area.x, recall)], ["cy", pixel(area.y, precision)], ["r", 6]]) ring.setAttribute(key, value);
  };
  slider.max = data.steps.length - 1;
  const clean = data.steps.filter((step) => step[2] === 0).length;
  const asked = data.steps.filter((step) => step[0] >= data.asked).length;
  slider.value = (data.asked !== null ? asked || 1 : data.judged && clean ? clean : data.steps.length) - 1;
  slider.addEventListener("input", accept);
  byId("cut").hidden = false;
  accept();
})();
