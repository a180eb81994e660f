#!/usr/bin/python3
"""Converts VPR-Bench's ground truth to pairs as CSV.

  scripts/convert/vpr_bench.py ground_truth_new.npy > pairs.csv

The file has a row (query, list of references) for every query or, as GSV-Cities stores it, one list
or array of references for every query; an array of integers has one row of references, or one
reference, for every query. Others are Python pickles, which can execute code: anything except lists,
numbers and NumPy arrays is refused. Needs NumPy (python3-numpy)."""
import pickle
import sys

import numpy

PARTS = {"_reconstruct", "scalar", "ndarray", "dtype", "range", "xrange"}
HOMES = {"numpy", "numpy.core.multiarray", "numpy._core.multiarray", "builtins", "__builtin__"}


class Reader(pickle.Unpickler):
    def find_class(self, module, name):
        if module not in HOMES or name not in PARTS:
            raise pickle.UnpicklingError(f"it would run {module}.{name}")
        return super().find_class(module, name)


if len(sys.argv) != 2:
    sys.exit(__doc__)
try:
    with open(sys.argv[1], "rb") as file:
        first = numpy.lib.format.read_magic(file) == (1, 0)  # headers of 2.0 and 3.0 differ in encoding only
        header = numpy.lib.format.read_array_header_1_0 if first else numpy.lib.format.read_array_header_2_0
        kind = header(file)[2].kind
        table = Reader(file, encoding="latin1").load() if kind == "O" else numpy.load(sys.argv[1])
    if kind not in "Oiu":
        raise ValueError("is an array of other values than integers and lists, not a ground truth")
    if table.size == len(table):  # N x 1
        table = table.reshape(-1)
    if kind != "O" or all(isinstance(entry, (int, numpy.integer)) for entry in table):
        rows = enumerate(map(numpy.ravel, table))
    else:
        rows = table if table.ndim == 2 else enumerate(table)
    try:
        pairs = [(query, reference) for query, references in rows for reference in references]
    except (TypeError, ValueError):
        raise ValueError("a row is neither a list of references nor a query with its list. VPR-Bench's "
                         "precomputed_data_corrected.npy holds matches and scores; use ground_truth_new.npy") from None
    if any(int(number) != number for pair in pairs for number in pair):
        raise ValueError("a query or reference is not an integer")
except Exception as error:  # a damaged file can raise any kind
    sys.exit(f"{sys.argv[1]}: {error}")
print("query,reference", *(f"{int(query)},{int(reference)}" for query, reference in pairs), sep="\n")
