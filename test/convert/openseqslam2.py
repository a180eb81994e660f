#!/usr/bin/env python3
"""The CSV of OpenSeqSLAM2 as pairs: openseqslam2.py SOURCE BIN."""
import support

folder, convert = support.folder, support.converter("openseqslam2.py")


def converted(text, *more):
    (folder / "g.csv").write_text(text)
    return convert(folder / "g.csv", "--train-frames", "4", "-o", folder / "p.csv", "--force", *more)


support.good(converted("1,1,1\n2, 3 ,0\n\n3,4,9\n4,2\n"))
assert (folder / "p.csv").read_text() == "query,reference\n" + "".join(
    f"{pair}\n" for pair in ("0,0", "0,1", "1,2", "2,0", "2,1", "2,2", "2,3", "3,1"))
support.evaluated(folder / "p.csv", "--query-frames", "4", "--train-frames", "4")
support.named(folder / "g.csv", "openseqslam2.py")
for bad in "0,1,0", "1,0,0", "1,5,0", "1,1,-1", "1", "1,1,1,1", "1,x,0", "1,1.5,0":
    support.refused(converted(f"1,1,1\n{bad}\n"), 4, "g.csv, line 2")
support.refused(converted(""), 4, "is empty")
(folder / "binary.csv").write_bytes(b"1,1,1\n\x89PNG\0\n")
support.refused(convert(folder / "binary.csv", "--train-frames", "4", "-o", folder / "x.csv"), 4, "binary.csv, line 2")
support.refused(convert(folder / "none.csv", "--train-frames", "4", "-o", folder / "x.csv"), 3, "none.csv")
