#!/usr/bin/python3
"""Write the GPS positions and times in the EXIF tags of images as a CSV.

  exif.py photos -o photos.csv

The CSV has one line per image in the order of the frames, with the columns image, lat, lon and,
if images have them, heading and time (seconds since 1970). Use it with --ground-truth and
--query-images photos, and with --query-times for the times. Fields are empty if an image has no
position: no tags, 0 N 0 E, or a receiver without a fix. The time is the time of the camera's clock in
its time zone, or else of the GPS fix, which is UTC. A clock without a time zone is corrected by the
GPS times; without them, it is read as UTC.
Needs python3-pil.
"""
import csv
import datetime
import io
import math
import re
import sys

import common

SUFFIXES = {".jpg", ".jpeg", ".jpe", ".jfif", ".png", ".bmp", ".dib", ".pgm", ".ppm", ".pnm", ".tif",
            ".tiff", ".webp"}
NUMBER = re.compile(r"(.*[^0-9.]|)([0-9]+(?:\.[0-9]+)?)")  # after a prefix
GPS, CAMERA = 0x8825, 0x8769  # directories of tags
DATE_TIME, OFFSET_TIME = 0x0132, 0x9010
CLOCKS = ((0x9003, 0x9291, 0x9011), (0x9004, 0x9292, 0x9012),  # times original and digitized, with
          (DATE_TIME, 0x9290, OFFSET_TIME))  # their fractions of a second and time zones


def number(value):
    """A tag as a number; NaN for a division by 0 and for other values."""
    try:
        return float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return math.nan


def text(tags, key):
    return str(tags.get(key, "")).strip("\0 ")


def degrees(parts):
    if not isinstance(parts, tuple) or len(parts) != 3:
        return math.nan
    return sum(number(part) / 60 ** power for power, part in enumerate(parts))


def position(image, tags):
    """Latitude and longitude in degrees, or None."""
    values = [degrees(tags.get(key)) for key in (2, 4)]
    if any(map(math.isnan, values)) or values == [0, 0] or tags.get(9) == "V":
        return None
    for at, (letters, largest) in enumerate((("NS", 90), ("EW", 180))):
        letter = text(tags, 2 * at + 1)
        if len(letter) != 1 or letter not in letters:
            raise common.Refusal(common.DATA, f"{image}: its GPS position does not say whether it is "
                                              f"{letters[0]} or {letters[1]}")
        if values[at] > largest:
            raise common.Refusal(common.DATA, f"{image}: its GPS position {values} is not on the "
                                              "globe")
        values[at] *= 1 if letter == letters[0] else -1
    return values


def time_of_fix(tags):
    """Seconds since 1970, by the GPS, or None."""
    try:
        day = datetime.datetime.strptime(text(tags, 29).replace("-", ":") + "+0000", "%Y:%m:%d%z")
    except ValueError:
        return None
    hours = degrees(tags.get(7))
    return None if math.isnan(hours) or tags.get(9) == "V" else day.timestamp() + round(hours * 3600, 3)


def time_taken(tags):
    """Seconds since 1970 and whether a time zone is known, by the camera's clock, or None."""
    for keys in CLOCKS:
        taken, fraction, zone = (text(tags, key) for key in keys)
        if text(tags, DATE_TIME) in ("", taken):  # an edited image can have another time and zone
            zone = zone or text(tags, OFFSET_TIME)
        zone = zone.replace(":", "").strip()  # blanks and a colon: unknown
        try:
            time = datetime.datetime.strptime(taken + (zone or "+0000"), "%Y:%m:%d %H:%M:%S%z")
        except ValueError:
            continue
        digits = float("0." + fraction) if fraction.isdigit() else 0
        return time.timestamp() + digits, bool(zone)
    return None


def known_times(fixes, clocks):
    """The times of the images, and how far clocks without a time zone are ahead (None: unknown).

    Times of fixes are often integers and may be minutes old, so they only correct the clocks: by the latest
    fix within 15 minutes of the median, or to a time zone, if there is one fix or the difference is one.
    """
    used = [(clock[0] - fix, fix) for fix, clock in zip(fixes, clocks) if fix is not None and clock and not clock[1]]
    middle = sorted(used)[(len(used) - 1) // 2][0] if used else 0
    ahead = min((late for late, _ in used if late >= middle - 900), default=None)
    zone = 900 * round((ahead or 0) / 900)
    if used and (len({fix for _, fix in used}) == 1 or abs(ahead - zone) < 2):
        ahead = zone
    times = [clock[0] - (0 if clock[1] else ahead or 0) if clock else fix for fix, clock in zip(fixes, clocks)]
    return times, ahead


def read_tags(image_module, path):
    """The GPS tags, and the camera's with DateTime; a TIFF must be open when they are read."""
    try:
        with image_module.open(path) as image:
            tags = image.getexif()
            return tags.get_ifd(GPS), {DATE_TIME: tags.get(DATE_TIME, ""), **tags.get_ifd(CAMERA)}
    except (OSError, SyntaxError, ValueError):
        raise common.Refusal(common.FILES, f"{path}: cannot read image") from None


def natural(path):
    """Integers in names compare by value."""
    return [int(part) if part.isdigit() else part for part in re.split(r"([0-9]+)", path.name)]


def frames(folder):
    """The images that programs read, in their order: decimal numbers by value."""
    images = sorted((path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES
                     and not path.name.startswith(".") and not path.is_dir()), key=natural)
    parts = [NUMBER.fullmatch(path.stem) for path in images]
    if not all(parts) or len({part[1] for part in parts}) > 1 or not any("." in part[2] for part in parts):
        return images
    values = {path: float(part[2]) for path, part in zip(images, parts)}
    return sorted(images, key=values.get) if len(set(values.values())) == len(images) else images


def convert(arguments):
    image_module = common.need("PIL.Image", "python3-pil")
    folder = arguments.source
    rows, fixes, clocks = [], [], []
    for path in frames(folder):
        gps, camera = read_tags(image_module, path)
        place = position(path, gps) or ("", "")
        heading = number(gps.get(17))
        fixes.append(time_of_fix(gps))
        clocks.append(time_taken(camera))
        rows.append({"image": path.name, "lat": place[0], "lon": place[1],
                     "heading": heading if 0 <= heading <= 360 else ""})
    times, ahead = known_times(fixes, clocks)
    for row, time in zip(rows, times):
        row["time"] = "" if time is None else f"{time:.6f}".rstrip("0").rstrip(".")
    if all(row["lat"] == "" and row["time"] == "" for row in rows):
        raise common.Refusal(common.DATA, f"{folder}: no image has a GPS position or a time in its "
                                          "EXIF tags")
    lacks_zone = sum(clock is not None and not clock[1] for clock in clocks)
    if lacks_zone and ahead is not None:
        print(f"exif.py: {folder}: {lacks_zone} of {len(rows)} images have no time zone; the clock of their "
              f"camera is corrected by {-ahead} s, by the GPS times", file=sys.stderr)
    elif lacks_zone:
        print(f"exif.py: {folder}: times without a time zone are read as UTC; for a camera two "
              "hours ahead, use --offset -7200", file=sys.stderr)
    columns = ["image", "lat", "lon",
               *(key for key in ("heading", "time") if any(row[key] != "" for row in rows))]
    output = io.StringIO()
    table = csv.DictWriter(output, columns, extrasaction="ignore", lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    common.write(arguments, output.getvalue())


common.run(common.parser(__doc__, "FOLDER", "FILE.csv").parse_args(), convert)
