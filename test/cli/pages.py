#!/usr/bin/env python3
"""Opens every page and chart at 1280 and 390 pixels, light and dark, saves screenshots, and fails if
anything is cut or overlaps. Skipped without Chromium.   pages.py SOURCE BIN SCREENSHOTS"""
import base64
import os
import sys

from chromium import Chromium
from support import folder, run, source, write

# Returns one line per defect of the page.
CHECK = r"""(async () => {
  const found = [], wide = innerWidth > 800;
  const name = (element) => `${element.tagName.toLowerCase()}.${element.className.baseVal ?? element.className}`
    + ` "${element.textContent.trim().slice(0, 40)}"`;
  const shown = (element) => element.checkVisibility();
  const width = document.documentElement.scrollWidth;
  if (width > innerWidth) found.push(`the page is ${width} pixels wide`);
  for (const element of document.querySelectorAll("body *:not(svg *)")) {
    if (!shown(element)) continue;
    const style = getComputedStyle(element), scrolls = element.scrollWidth > element.clientWidth + 1;
    const isBox = element.clientWidth > 0 && style.display !== "inline";
    if (scrolls && isBox && style.overflowX === "hidden") found.push(`${name(element)} is cut`);
    if (scrolls && isBox && style.overflowX === "visible" && !element.closest(".scroll"))
      found.push(`${name(element)} is wider than its box: ${element.scrollWidth} in ${element.clientWidth}`);
    if (scrolls && isBox && style.overflowX === "auto" && (wide || !element.querySelector("table")))
      found.push(`${name(element)} scrolls: ${element.scrollWidth} in ${element.clientWidth}`);
  }
  // The corners of a text on the screen; rotated text has a rotated box.
  const corners = (text) => {
    const box = text.getBBox(), matrix = text.getScreenCTM();
    return [[box.x, box.y], [box.x + box.width, box.y], [box.x + box.width, box.y + box.height], [box.x, box.y + box.height]]
      .map(([x, y]) => new DOMPoint(x, y).matrixTransform(matrix));
  };
  // Separating axes; a pixel of overlap is allowed, since boxes of text include white space.
  const overlap = (a, b, allowed = 1) => [a, b].every((box) => box.every((point, i) => {
    const next = box[(i + 1) % 4], length = Math.hypot(next.x - point.x, next.y - point.y) || 1;
    const axis = [(point.y - next.y) / length, (next.x - point.x) / length];
    const [from, to] = [a, b].map((one) => one.map((p) => p.x * axis[0] + p.y * axis[1]));
    return Math.min(Math.max(...from), Math.max(...to)) - Math.max(Math.min(...from), Math.min(...to)) > allowed;
  }));
  for (const svg of document.querySelectorAll("svg")) {
    if (svg.ownerSVGElement || !shown(svg)) continue;
    const texts = [...svg.querySelectorAll("text")].filter((text) => shown(text) && text.textContent);
    const boxes = texts.map(corners), outer = svg.getBoundingClientRect();
    texts.forEach((text, i) => {
      if (parseFloat(getComputedStyle(text).fontSize) * svg.getScreenCTM().a < 8.5) found.push(`${name(text)} is tiny`);
      if (boxes[i].some((p) => p.x < outer.left - 1 || p.x > outer.right + 1 || p.y < outer.top - 1 || p.y > outer.bottom + 1))
        found.push(`${name(text)} is outside its chart`);
      for (let k = 0; k < i; ++k)
        if (overlap(boxes[i], boxes[k])) found.push(`${name(text)} covers ${name(texts[k])}`);
    });
    // Absolute positions in the paths of points and lines.
    for (const path of svg.querySelectorAll("path.line")) {
      const matrix = path.getScreenCTM();
      for (const [, x, y] of path.getAttribute("d").matchAll(/[ML](-?[\d.]+) (-?[\d.]+)/g)) {
        const at = new DOMPoint(x, y).matrixTransform(matrix);
        const dot = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([i, k]) => new DOMPoint(at.x + i, at.y + k));
        const text = texts.find((_, i) => overlap(boxes[i], dot, 1));
        if (text) { found.push(`${name(text)} covers a point of ${name(path)}`); break; }
      }
    }
  }
  for (const image of document.querySelectorAll("img, image")) {
    const copy = new Image();
    copy.src = image.getAttribute("src") ?? image.getAttribute("href");
    await copy.decode().catch(() => found.push(`${name(image)} has no image`));
  }
  return found;
})()"""


PAGES = """
vpr-synth SOURCE/configs/worlds/small.json -o world
vpr-train fastable --dataset DATA --c-l 20 -o s.vprdb
vpr-train fabmap --dataset DATA --words 200 --features orb -o f.vprdb
vpr-query s.vprdb --dataset DATA -o filter.json
vpr-query s.vprdb --dataset DATA --c-l 20 --t-r 0.6 --save-matrix windows.npy -o windows.json
vpr-query s.vprdb --dataset DATA --c-l 1 --t-r 0.3 -o frames.json
vpr-query f.vprdb --dataset DATA --c-w 1 --t-p 0.9 -o fabmap.json
vpr-eval filter.json --dataset DATA --html filter.html --plot plots-filter -o reports/filter.json
vpr-eval windows.json --dataset DATA --html windows.html --plot plots-windows -o reports/windows.json --matrix windows.npy --map plots-map
vpr-eval frames.json --dataset DATA --html frames.html --plot plots-frames -o reports/frames.json
vpr-eval fabmap.json --dataset DATA --html fabmap.html --plot plots-fabmap -o reports/fabmap.json
vpr-eval frames.json --html unjudged.html
vpr-eval windows.json --dataset DATA --ask-places places.html
vpr-eval windows.json --dataset DATA --ask-fabmap mark.html
vpr-tune fastable s.vprdb --dataset DATA --c-l 1,5,10,20 --t-r 0.2:0.8:0.1 --plot plots-tune
vpr-query s.vprdb --query world/query --c-l 1 --t-r 0.3 --save-matrix all.npy -o all.json
vpr-eval matrix all.npy --distance --ground-truth aligned --recall-at 1,5,10 --html matrix.html --plot plots-matrix
vpr-eval compare reports/filter.json reports/windows.json reports/frames.json --html compare.html --plot plots-compare
vpr-eval loops loops.csv --poses path.txt --radius 2 --gap 20s --similarity --html loops.html --plot plots-loops
"""


def make_pages():
    """Every kind of page, with its charts as SVG files, from a rendered building."""
    (folder / "reports").mkdir()
    write("path.txt", "".join(f"{100 + frame} {min(frame % 40, 20, 40 - frame % 40)} {frame % 40 // 2} 0 0 0 0 1\n"
                              for frame in range(120)))
    write("loops.csv", "query,match,score\n" + "".join(
        f"{frame},{frame % 40 if frame % 7 else frame % 11},{frame % 13}\n" for frame in range(45, 120, 2)))
    for command in PAGES.strip().replace("SOURCE", str(source)).replace("DATA", "world/dataset.json").splitlines():
        run(*command.split(), "--quiet")


class Photographer:
    """Opens files and saves screenshots of all of their content."""

    def __init__(self, browser, screenshots):
        self.browser, self.screenshots = browser, screenshots
        os.makedirs(screenshots, exist_ok=True)

    def defects(self, path, width, theme):
        call = self.browser.call
        call("Emulation.setEmulatedMedia",
             features=[{"name": "prefers-color-scheme", "value": theme}])
        call("Emulation.setDeviceMetricsOverride", width=width, height=900, mobile=width < 800,
             deviceScaleFactor=1)
        self.browser.open(path)
        folder, file = os.path.split(os.path.abspath(path))
        name, kind = os.path.splitext(file)
        if kind == ".svg":
            name = f"{os.path.basename(folder)}-{name}"
        height = call("Page.getLayoutMetrics")["cssContentSize"]["height"]
        picture = call("Page.captureScreenshot", captureBeyondViewport=True,
                       clip={"x": 0, "y": 0, "width": width, "height": height, "scale": 1})
        with open(f"{self.screenshots}/{name}-{width}-{theme}.png", "wb") as file:
            file.write(base64.b64decode(picture["data"]))
        return [f"{name}, {width} pixels, {theme}: {line}" for line in self.browser.evaluate(CHECK)]

    def all_defects(self, paths):
        found = []
        for path in paths:
            is_page = path.endswith(".html")
            for width in (1280, 390) if is_page else (1280,):
                for theme in ("light", "dark") if is_page else ("light",):
                    found += self.defects(path, width, theme)
        return found


def damage_is_found(photographer, page):
    """Each kind of damage is reported."""
    damages = {
        "the page is": ("</body>", "<div style='width:2000px'>wide</div></body>"),
        "is cut": ("</body>", "<div style='width:3em;overflow:hidden;white-space:pre'>much text</div></body>"),
        "covers text": ("</text>", "</text><text x='99' y='99'>a</text><text x='99' y='99'>b</text>"),
        "is outside its chart": ("</text>", "</text><text x='-99' y='9'>out</text>"),
        "covers a point": ("</text>", "</text><text x='99' y='99'>a</text><path class='line' d='M100 96h0'/>"),
        "is tiny": ("</text>", "</text><text x='99' y='99' style='font-size:3px'>a</text>"),
        "has no image": ("<img ", "<img src='data:image/png;base64,AAAA'><img "),
    }
    html = page.read_text()
    for words, (place, damage) in damages.items():
        assert place in html, place
        broken = folder / write("broken.html", html.replace(place, damage, 1))
        found = photographer.defects(broken, 1280, "light")
        assert any(words in line for line in found), (words, found)


make_pages()
screenshots = sys.argv[3]
files = sorted(map(str, [*folder.glob("*.html"), *folder.glob("plots-*/*.svg")]))
with Chromium(folder / "profile") as browser:
    photographer = Photographer(browser, screenshots)
    defects = photographer.all_defects(files)
    damage_is_found(photographer, folder / "filter.html")
print(f"{len(files)} files, screenshots in {screenshots}", *defects, sep="\n")
sys.exit(1 if defects else 0)
