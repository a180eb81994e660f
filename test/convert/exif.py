#!/usr/bin/env python3
"""EXIF tags of images as CSV: exif.py SOURCE BIN."""
import shutil

import support

image_module, tiff = support.packages("PIL.Image", "PIL.TiffImagePlugin")
folder, convert = support.folder, support.converter("exif.py")
photos = folder / "photos"


def image(name, gps=None, camera=None, main=()):
    exif = image_module.Exif()
    exif.update({tag: tags for tag, tags in ((0x8825, gps), (0x8769, camera)) if tags})
    exif._ifds.update(exif)  # Pillow writes these to a TIFF
    exif.update(main)
    photos.mkdir(exist_ok=True)
    image_module.new("L", (8, 8)).save(photos / name, exif=exif)


def angle(degrees, minutes, hundredths, divisor=100):
    return tuple(tiff.IFDRational(*part) for part in ((degrees, 1), (minutes, 1), (hundredths, divisor)))


def place(hundredths, **more):
    tags = {1: "N", 2: angle(52, 0, hundredths), 3: "E", 4: angle(13, 0, 0)}
    return {**tags, **{int(key[1:]): value for key, value in more.items()}}


def rows():
    outcome = support.good(convert(photos, "-o", folder / "p.csv", "--force"))
    return (folder / "p.csv").read_text().splitlines(), outcome.stderr


image("IMG_10.jpg", place(36, _1="S", _3="W", _17=tiff.IFDRational(181, 2)),
      {0x9003: "2024:05:01 14:00:03", 0x9291: "25", 0x9011: "+02:00"})
image("IMG_9.jpg", place(0), {0x9003: "2024:05:01 12:00:00"})
for other in ("notes.txt", "._9.jpg"):
    (photos / other).write_text("x")
lines, warning = rows()
assert lines == ["image,lat,lon,heading,time", "IMG_9.jpg,52.0,13.0,,1714564800",
                 "IMG_10.jpg,-52.0001,-13.0,90.5,1714564803.25"], lines
assert "--offset -7200" in warning

# Decimal names by value, as programs order them.
for name in ("8.04.jpg", "8.2.jpg", "8.12.bmp"):
    (folder / "decimal").mkdir(exist_ok=True)
    shutil.copy(photos / "IMG_9.jpg", folder / "decimal" / name)
support.good(convert(folder / "decimal", "-o", folder / "d.csv"))
assert [line.split(",")[0] for line in (folder / "d.csv").read_text().split()] == ["image", "8.04.jpg", "8.12.bmp", "8.2.jpg"]

# Positions of the query by name, and times of the frames.
image("IMG_10.jpg", place(20), {0x9003: "2024:05:01 12:00:03"})
rows()
(folder / "r.csv").write_text("lat,lon\n52,13\n52.0000555,13\n")
truth = (folder / "p.csv", "--ground-truth-train", folder / "r.csv", "--radius", "1")
for more in (("--query-images", photos), ("--query-times", folder / "p.csv")):
    support.good(support.run(support.programs / "vpr-eval", "convert", *truth, *more, "--to", "pairs", "-o",
                             folder / "pairs.csv", "--force"))
    assert (folder / "pairs.csv").read_text() == "query,reference\n0,0\n1,1\n", more
outcome = support.run(support.programs / "vpr-eval", "check", photos, *truth[1:])
assert outcome.returncode != 0 and "scripts/convert/exif.py" in outcome.stderr, outcome


def times(*images):
    if photos.exists():
        shutil.rmtree(photos)
    for at, tags in enumerate(images):
        image(f"{at}.jpg", *tags)
    lines, warning = rows()
    return [line.split(",")[-1] for line in lines[1:]], warning


# The camera's clock comes before the time of the GPS fix, which corrects it.
photos.rename(folder / "kept")
fix = {"_7": angle(12, 0, 150), "_29": "2024:05:01"}
clock = {0x9003: "2024:05:01 14:00:01"}
fixed = place(0, **fix)
found, warning = times((fixed, clock), (place(0), {0x9003: "2024:05:01 14:00:09"}), (fixed,),
                       (fixed, {**clock, 0x9011: "+01:00"}), ({**fixed, 9: "V"},), ({**fixed, 29: "0000:00:00"},),
                       ({**fixed, 29: "2024-05-01"},))
assert found == ["1714564801", "1714564809", "1714564801.5", "1714568401", "", "", "1714564801.5"], found
assert "2 of 7 images have no time zone" in warning and "by -7200 s" in warning, warning

# Four images per second, and an old fix of integer seconds that does not change.
for zone in ({}, {0x9011: "+02:00"}):
    found, _ = times(*(({**fixed, 7: angle(11, 55, 100)}, {**clock, 0x9291: digits, **zone})
                       for digits in ("25", "5", "75")))
    assert found == ["1714564801.25", "1714564801.5", "1714564801.75"], found

# A clock that is four minutes slow, and an old fix between two new ones.
found, _ = times(*(({**fixed, 7: angle(12, minute, 100)}, {0x9003: f"2024:05:01 14:0{at}:01"})
                   for at, minute in enumerate((4, 4, 6))))
assert found == ["1714565041", "1714565101", "1714565161"], found

# The first valid time, with its own fraction and zone; OffsetTime if DateTime is not another time.
other = {0x9291: "1", 0x9292: "2", 0x9290: "3", 0x9012: "+01:00", 0x9010: "+03:00"}
later, unknown = {0x0132: "2024:05:01 15:00:00"}, {0x9003: "    :  :     :  :  "}
found, _ = times((fixed, {**other, **clock, 0x9004: clock[0x9003]}),
                 (fixed, {**other, **unknown, 0x9004: clock[0x9003]}), (fixed, other, later),
                 (fixed, {**other, **clock}, later), (fixed, {**other, **clock, 0x9011: "   :  "}, later))
assert found == ["1714561201.1", "1714568401.2", "1714564800.3", "1714564801.1", "1714564801.1"], found
shutil.rmtree(photos)
(folder / "kept").rename(photos)

# Invalid positions.
for bad in (place(0, _9="V"), place(0, _2=angle(52, 0, 0, 0)), {}, {2: angle(0, 0, 0), 4: angle(0, 0, 0)}):
    image("IMG_10.jpg", bad)
    assert rows()[0][2] == "IMG_10.jpg,,,", bad
for bad, words in ((place(0, _2=angle(95, 0, 0)), "not on the globe"), (place(0, _3=""), "E or W")):
    image("IMG_10.jpg", bad)
    support.refused(convert(photos, "-o", folder / "x.csv"), 4, words)
(photos / "IMG_10.jpg").write_bytes(b"\xff\xd8\xff")
support.refused(convert(photos, "-o", folder / "x.csv"), 3, "IMG_10.jpg")
shutil.rmtree(photos)
image("a.jpg")
support.refused(convert(photos, "-o", folder / "x.csv"), 4, "no image has a GPS position")
support.refused(convert(folder / "none", "-o", folder / "x.csv"), 3, "none")
image("a.tif", place(0))
assert rows()[0] == ["image,lat,lon", "a.jpg,,", "a.tif,52.0,13.0"]
