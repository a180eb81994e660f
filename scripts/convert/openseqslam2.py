#!/usr/bin/python3
"""Write the ground truth CSV of OpenSeqSLAM2 as pairs.

  openseqslam2.py ground_truth.csv --train-frames 1000 -o pairs.csv

Lines of the CSV are query,reference[,tolerance], counted from 1, without a header. References
within the tolerance are the same place, from the first training frame to the last one.
"""
import csv

import common


def convert(arguments):
    path, frames = arguments.source, arguments.train_frames
    pairs = set()
    with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
        for number, row in enumerate(csv.reader(file), 1):
            if not row:
                continue
            try:
                query, reference, tolerance = [int(field) for field in row + ["0"] * (3 - len(row))]
            except ValueError:
                raise common.Refusal(common.DATA, f"{path}, line {number}: expected two or three "
                                                  "integers: query, reference, tolerance") from None
            if query < 1 or not 1 <= reference <= frames or tolerance < 0 or len(row) < 2:
                raise common.Refusal(common.DATA, f"{path}, line {number}: out of range; frames "
                                                  f"count from 1, and there are {frames} training "
                                                  "frames")
            pairs.update((query - 1, near - 1) for near in range(
                max(1, reference - tolerance), min(frames, reference + tolerance) + 1))
    if not pairs:
        raise common.Refusal(common.DATA, f"{path}: is empty")
    common.write(arguments, "query,reference\n" + "".join(
        f"{query},{reference}\n" for query, reference in sorted(pairs)))


parser = common.parser(__doc__, "FILE.csv", "PAIRS.csv")
parser.add_argument("--train-frames", type=int, required=True, metavar="N",
                    help="number of training frames")
common.run(parser.parse_args(), convert)
