#!/usr/bin/env python3
"""Best matches that are right, and those before the first wrong one when sorted by score, in per
cent, of aligned sequences: recognised_early.py RESULT.best.npy TOLERANCE"""
import array
import sys

with open(sys.argv[1], "rb") as file:
    content = file.read()
values = array.array("i")
values.frombytes(content[10 + int.from_bytes(content[8:10], "little"):])
best = [values[row:row + 4] for row in range(0, len(values), 4)]
tolerance = int(sys.argv[2])
right = [abs(train - query) <= tolerance for query, _, train, _ in best]
by_score = sorted(range(len(best)), key=lambda row: best[row][3])
early = next((n for n, row in enumerate(by_score) if not right[row]), len(best))
print(f" | {100 * sum(right) / len(best):.1f} / {100 * early / len(best):.0f}", end="")
