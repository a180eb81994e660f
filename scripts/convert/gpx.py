#!/usr/bin/python3
"""Write the track of a GPX file as a CSV of GPS positions.

  gpx.py tuesday.gpx -o tuesday.csv

The CSV has the columns lat and lon, and time if the track has times (UTC). It holds the points
of all tracks and segments in the order of the file; waypoints and routes are ignored, and, in a
track with times, points without one. A document type, and therefore every entity, is refused.
"""
import re
import sys
import xml.etree.ElementTree

import common


def local(tag):
    return tag.rpartition("}")[2]


def convert(arguments):
    path = arguments.source

    def fail(what):
        raise common.Refusal(common.DATA, f"{path}: {what}")
    content = path.read_bytes()
    if re.search(rb"<!\s*DOCTYPE", content.replace(b"\0", b""), re.IGNORECASE):
        fail("has a document type (<!DOCTYPE>), which GPX does not use")
    try:
        root = xml.etree.ElementTree.fromstring(content)
    except (xml.etree.ElementTree.ParseError, ValueError, LookupError) as error:
        fail(f"is damaged XML ({error})")
    if local(root.tag) != "gpx":
        fail(f"is not GPX: its root is <{local(root.tag)}>")
    points = []
    for point in (node for node in root.iter() if local(node.tag) == "trkpt"):
        times = [(node.text or "").strip() for node in point if local(node.tag) == "time"]
        try:
            float(point.get("lat")), float(point.get("lon"))
        except (TypeError, ValueError):
            fail(f"track point {len(points)} has no latitude or longitude")
        points.append((point.get("lat").strip(), point.get("lon").strip(), *times[:1]))
    if not points:
        fail("has no track points (<trkpt>); waypoints and routes are not a recording")
    timed = [point for point in points if len(point) == 3 and point[2]]
    if timed and len(timed) < len(points):
        print(f"gpx.py: warning: {path}: {len(points) - len(timed)} of {len(points)} track points have no time "
              "and are omitted", file=sys.stderr)
        points = timed
    if any("," in field for point in points for field in point):
        fail("a time has a comma")
    header = ("lat", "lon", "time")[:len(points[0])]
    common.write(arguments, "".join(",".join(row) + "\n" for row in (header, *points)))


common.run(common.parser(__doc__, "TRACK.gpx", "FILE.csv").parse_args(), convert)
