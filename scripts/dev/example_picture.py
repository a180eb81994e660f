#!/usr/bin/env python3
"""Draws README's image from data/example: query photographs with their matches, and the answers of
each method along the lap.   example_picture.py BIN IMAGE"""
import csv
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw, ImageFont

root = pathlib.Path(__file__).resolve().parents[2]
programs, image = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
example = root / "data/example"
METHODS = [("filter", []), ("FastABLE", ["--c-l", "20", "--t-r", "0.7"]),
           ("z-score windows", ["--c-l", "20", "--score", "zscore", "--decide", "margin"])]
SHOWN = [3, 10, 17, 24, 35]  # query frames
COLORS = {"correct": "#2a6fb0", "incorrect": "#e0812e", "none": "white"}
WIDTH, HEIGHT, GAP, LABEL, LEFT = 184, 138, 12, 22, 12
DEJAVU = "/usr/share/fonts/truetype/dejavu/DejaVuSans"
font, bold = ImageFont.truetype(f"{DEJAVU}.ttf", 15), ImageFont.truetype(f"{DEJAVU}-Bold.ttf", 15)


def run(folder, program, *words):
    subprocess.run([programs / program, *words, "--quiet"], cwd=folder, check=True)


def answers(folder):
    """By method, the rows of all query frames; and whether a frame of the rendered building is recognized."""
    run(folder, "vpr-train", "images", "--train", example / "monday", "-o", "db")
    found = {}
    for name, flags in METHODS:
        run(folder, "vpr-query", "db", "--query", example / "tuesday", *flags, "-o", f"{name}.json")
        run(folder, "vpr-eval", f"{name}.json", "--ground-truth", example / "pairs.csv", "--outcomes-csv", f"{name}.csv")
        with (folder / f"{name}.csv").open() as rows:
            found[name] = list(csv.DictReader(rows))
    run(folder, "vpr-synth", root / "configs/worlds/building.json", "-o", "building")
    run(folder, "vpr-query", "db", "--query", "building/tuesday", "-o", "other.json")
    run(folder, "vpr-eval", "other.json", "--outcomes-csv", "other.csv")
    with (folder / "other.csv").open() as rows:
        other = list(csv.DictReader(rows))
    return found, other


def photograph(canvas, path, column, row):
    at = (LEFT + column * (WIDTH + GAP), LABEL + 4 + row * (HEIGHT + LABEL + 4))
    with Image.open(path) as frame:
        canvas.paste(frame.convert("RGB").resize((WIDTH, HEIGHT), Image.LANCZOS), at)
    return at


def main():
    draw_width = LEFT + 6 * (WIDTH + GAP)
    top = 2 * (HEIGHT + LABEL + 4) + 54
    canvas = Image.new("RGB", (draw_width, top + len(METHODS) * 34 + 40), "white")
    draw = ImageDraw.Draw(canvas)
    queries, trained = sorted((example / "tuesday").glob("*.jpg")), sorted((example / "monday").glob("*.jpg"))
    bar_left = LEFT + 160
    bar_width = (draw_width - bar_left - 240) / len(queries)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        found, other = answers(folder)
        for column, query in enumerate(SHOWN):
            x, y = photograph(canvas, queries[query], column, 0)
            draw.text((x, y - LABEL + 1), f"query frame {query}", fill="black", font=bold)
            row = found["filter"][query]
            below = (x, y + HEIGHT + 4)
            if row["recognition"] == "none":
                draw.text((below[0], below[1] + 60), "not sure: no answer", fill="black", font=font)
            else:
                photograph(canvas, trained[int(row["train_frame"])], column, 1)
                draw.text(below, f"= frame {row['train_frame']} of lap 1", fill="black", font=font)
            foot = (bar_left + (query + 0.5) * bar_width, top - 4)
            draw.line([(x + WIDTH / 2, top - 34), foot], fill="#999999")
        x, y = photograph(canvas, folder / "building/tuesday/00060.jpg", 5, 0)
    recognized = sum(row["recognition"] != "none" for row in other)
    draw.text((x, y - LABEL + 1), "a rendered building", fill="black", font=bold)
    draw.multiline_text((x, y + HEIGHT + 64), "no answer" if recognized == 0 else f"{recognized} wrong answers", fill="black", font=font)
    for line, (name, flags) in enumerate(METHODS):
        y = top + line * 34
        draw.text((LEFT, y + 4), name, fill="black", font=bold)
        kinds = [row["recognition"] for row in found[name]]
        for frame, kind in enumerate(kinds):
            x = bar_left + frame * bar_width
            draw.rectangle([x, y, x + bar_width, y + 26], fill=COLORS[kind], outline="#888888")
        draw.text((bar_left + len(kinds) * bar_width + 12, y + 4),
                  f"{kinds.count('correct')} right, {kinds.count('incorrect')} wrong of {len(kinds)}", fill="black", font=font)
        print(name, *flags, {kind: kinds.count(kind) for kind in COLORS})
    print("another building:", recognized, "of", len(other))
    y = top + len(METHODS) * 34 + 12
    x = bar_left
    for text, kind in (("recognized", "correct"), ("no answer", "none"), ("wrong", "incorrect")):
        draw.rectangle([x, y, x + 18, y + 18], fill=COLORS[kind], outline="#888888")
        draw.text((x + 26, y), text, fill="black", font=font)
        x += 140
    draw.text((x, y), "along the second lap, frames 0 to 39", fill="black", font=font)
    canvas.save(image, quality=88)


main()
