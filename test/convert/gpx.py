#!/usr/bin/env python3
"""GPX tracks as CSV: gpx.py SOURCE BIN."""
import support

folder, convert = support.folder, support.converter("gpx.py")


def track(points):
    return ('<?xml version="1.0"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">\n'
            f'<wpt lat="1" lon="1"/>\n<trk><trkseg>{points}</trkseg></trk></gpx>\n')


def point(latitude, time=None):
    return (f'<trkpt lat="{latitude}" lon="13"><ele>34</ele>'
            + (f"<time>{time}</time>" if time else "") + "</trkpt>\n")


def converted(text):
    (folder / "t.gpx").write_text(text)
    return convert(folder / "t.gpx", "-o", folder / "t.csv", "--force")


support.good(converted(track(
    point(52, "2024-05-01T12:00:00Z") + "</trkseg><trkseg>" + point(52.0002, " 2024-05-01T14:00:01.5+02:00\n")
    + "</trkseg></trk><trk><trkseg>" + point(54, "2024-05-01T12:00:03Z"))))
assert (folder / "t.csv").read_text() == (
    "lat,lon,time\n52,13,2024-05-01T12:00:00Z\n52.0002,13,2024-05-01T14:00:01.5+02:00\n"
    "54,13,2024-05-01T12:00:03Z\n")
# Frames are located on the track by their times: at the first point, and halfway.
(folder / "times.txt").write_text("1714564800\n1714564800.75\n")
(folder / "r.csv").write_text("lat,lon\n52.0001,13\n52,13\n")
gps = ("--ground-truth-train", folder / "r.csv", "--radius", "1", "--query-times", folder / "times.txt")
support.good(support.run(support.programs / "vpr-eval", "convert", folder / "t.csv", *gps, "--to", "pairs",
                         "-o", folder / "p.csv"))
assert (folder / "p.csv").read_text() == "query,reference\n0,1\n1,0\n"
support.named(folder / "t.gpx", "gpx.py", *gps)

support.good(converted(track(point(52) + point(53))))
assert (folder / "t.csv").read_text() == "lat,lon\n52,13\n53,13\n"
# A point without time keeps the others.
found = converted(track(point(52, "2024-05-01T12:00:02Z") + point(53) + point(54, "2024-05-01T12:00:03Z")))
assert found.returncode == 0 and "1 of 3 track points have no time" in found.stderr, found
assert (folder / "t.csv").read_text() == "lat,lon,time\n52,13,2024-05-01T12:00:02Z\n54,13,2024-05-01T12:00:03Z\n"
for text, words in (
        (track('<trkpt lat="52"/>'), "track point 0 has no latitude or longitude"),
        (track(""), "no track points"), ("<kml/>", "<kml>"), (track(point(52))[:-22], "damaged XML"),
        ("", "damaged XML"), ("<gpx><trk></gpx>", "damaged XML"),
        ('<!DOCTYPE gpx [<!ENTITY a "ha">]><gpx><trk><trkseg>' + point(1, "&a;") + "</trkseg></trk></gpx>",
         "document type")):
    support.refused(converted(text), 4, words)
(folder / "u.gpx").write_bytes('<!DOCTYPE gpx SYSTEM "secret"><gpx/>'.encode("utf-16"))
support.refused(convert(folder / "u.gpx", "-o", folder / "x.csv"), 4, "document type")
