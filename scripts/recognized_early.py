#!/usr/bin/env python3
"""Percent of correct best matches, and of those before the first incorrect one in order of score,
of aligned sequences: recognized_early.py RESULT TOLERANCE, for RESULT.json"""
import array
import sys


def read(kind, number):
    with open(f"{sys.argv[1]}.{kind}.npy", "rb") as file:
        content = file.read()
    values = array.array(number)
    values.frombytes(content[10 + int.from_bytes(content[8:10], "little"):])
    return values


best = read("best", "i")  # query, target, train
scores = read("best_scores", "d")
tolerance = int(sys.argv[2])
right = [abs(best[row + 2] - best[row]) <= tolerance for row in range(0, len(best), 3)]
by_score = sorted(range(len(right)), key=lambda row: scores[row])
early = next((n for n, row in enumerate(by_score) if not right[row]), len(right))
print(f" | {100 * sum(right) / len(right):.1f} / {100 * early / len(right):.0f}", end="")
