#!/usr/bin/env python3
"""Output of scripts/convert/vpr_bench.py, and its use in the programs.
   vpr_bench.py SOURCE BIN; ends with 77 (skipped) without NumPy."""
import os
import pathlib

import support

numpy, = support.packages("numpy")
programs, folder, run = support.programs, support.folder, support.run
convert = support.converter("vpr_bench.py")
corridor = pathlib.Path(os.environ.get("VPR_TEST_DATA", support.source / "../shared"), "data/corridor")


def table(rows, shape):
    array = numpy.empty(shape, dtype=object)
    for at, row in enumerate(rows):
        array[at] = row
    path = folder / "g.npy"
    numpy.save(path, array, allow_pickle=True)
    return path


def check(path, expected):
    found = convert(path)
    assert (found.returncode, found.stdout) == (0, expected), (expected, found)


two = "query,reference\n0,1\n0,2\n2,0\n"
check(table([(0, [1, 2]), (1, []), (2, (0,))], (3, 2)), two)
check(table([(0, numpy.array([1, 2])), (1, range(0)), (2, [numpy.int64(0)])], (3, 2)), two)
check(table([[1, 2], numpy.array([], dtype=int), [0.0]], 3), two)
column = numpy.empty((3, 1), dtype=object)
column[:, 0] = [[1, 2], [], [0]]
for version in ((1, 0), (2, 0), (3, 0)):
    for array, expected in ((column, two), (numpy.array([1, 0]), "query,reference\n0,1\n1,0\n")):
        with open(folder / "v.npy", "wb") as file:
            numpy.lib.format.write_array(file, array, version)
        check(folder / "v.npy", expected)
for shape in (2, (2, 1)):
    check(table([1, numpy.int64(0)], shape), "query,reference\n0,1\n1,0\n")

# GSV-Cities' integers, one row per query; and VPR-Bench's matches, which are not a ground truth.
for array, expected in (([[1], [0]], "query,reference\n0,1\n1,0\n"), ([1, 0], "query,reference\n0,1\n1,0\n"),
                        ([[1, 2], [0, 3]], "query,reference\n0,1\n0,2\n1,0\n1,3\n")):
    numpy.save(folder / "i.npy", numpy.array(array))
    check(folder / "i.npy", expected)
numpy.save(folder / "s.npy", numpy.array([0.5, 1]))
for path, words in ((table([0.5, 1.5], 2), "precomputed_data_corrected.npy"),
                    (table([(0.5, [1], [2])] * 2, (2, 3)), "precomputed_data_corrected.npy"),
                    (table([1, [2]], 2), "neither a list of references"),
                    (folder / "s.npy", "other values than integers")):
    refused = convert(path)
    assert refused.returncode != 0 and words in refused.stderr, refused
table([(0, [1, 2]), (1, []), (2, (0,))], (3, 2))

# The programs read its output, and refuse its input with advice.
pairs = folder / "pairs.csv"
pairs.write_text(two)
checked = run(programs / "vpr-eval", "check", pairs, "--query-frames", "3", "--train-frames", "3")
assert checked.returncode == 0, checked
for words in (("check", folder / "g.npy"), ("check", folder / "g.npy", "--ground-truth-format", "vpr-bench"),
              ("convert", folder / "g.npy", "--to", "pairs", "-o", folder / "p.csv")):
    refused = run(programs / "vpr-eval", *words)
    assert refused.returncode == 2, refused
    assert "scripts/convert/vpr_bench.py" in refused.stderr, refused


# A pickle with code is refused without running it; so is a damaged one.
class Hostile:
    def __reduce__(self):
        return os.system, (f"touch {folder}/HERE",)


hostile = table([(0, [1]), (1, Hostile())], (2, 2))
refused = convert(hostile)
assert refused.returncode != 0 and "it would run" in refused.stderr, refused
assert not (folder / "HERE").exists()
whole = table([(0, [1, 2])], (1, 2)).read_bytes()
for bad in (whole[: len(whole) // 2], whole[:-4], b"", b"query,reference\n0,1\n"):
    (folder / "bad.npy").write_bytes(bad)
    refused = convert(folder / "bad.npy")
    assert refused.returncode != 0 and refused.stdout == "" and "bad.npy" in refused.stderr, refused
assert convert(table([(0, [0.5])], (1, 2))).returncode != 0
assert convert(folder / "none.npy").returncode != 0

if corridor.exists():
    check(corridor / "ground_truth_new.npy", (corridor / "ground_truth.csv").read_text())
