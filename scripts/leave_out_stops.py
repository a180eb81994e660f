#!/usr/bin/env python3
"""Lists the frames of aligned sequences that show motion: leave_out_stops.py IMAGES OUT NAME...

Frame i is omitted from every sequence IMAGES/NAME if, in all of them, it is within 100 bits of frame
i - 1. Reads OUT/NAME.vprdb, writes OUT/moving-NAME.txt."""
import pathlib
import sys

STANDING_BITS = 100
images, out = map(pathlib.Path, sys.argv[1:3])
names = sys.argv[3:]


def codes(name):
    content = (out / f"{name}.vprdb" / "codes.npy").read_bytes()
    rows = content[10 + int.from_bytes(content[8:10], "little"):]
    return [int.from_bytes(rows[i:i + 176], "little") for i in range(0, len(rows), 176)]


sequences = [codes(name) for name in names]
moving = [i for i in range(len(sequences[0]))
          if i == 0 or any((s[i] ^ s[i - 1]).bit_count() >= STANDING_BITS for s in sequences)]
for name in names:
    frames = (out / f"{name}.vprdb" / "frames.txt").read_text().splitlines()
    lines = [str((images / name / frames[i]).resolve()) for i in moving]
    (out / f"moving-{name}.txt").write_text("\n".join(lines) + "\n")
