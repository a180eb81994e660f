#!/usr/bin/env python3
"""MAT-files of each version as .npy files: mat.py SOURCE BIN."""
import json

import support

numpy, scipy_io, sparse, h5py = support.packages("numpy", "scipy.io", "scipy.sparse", "h5py")
folder, convert = support.folder, support.converter("mat.py")
truth = numpy.array([[1, 0, 0], [0, 0, 1]])


def check(name, expected, *more, dtype=None):
    support.good(convert(folder / name, "-o", folder / "o.npy", "--force", *more))
    found = numpy.load(folder / "o.npy")
    assert found.shape == expected.shape and (found == expected).all(), (name, found)
    assert found.flags.c_contiguous and dtype in (None, found.dtype.name), (name, found.dtype)


for number, kind in enumerate(("float64", "float32", "uint8", "int16", "uint64", "bool")):
    scipy_io.savemat(folder / "m.mat", {"loops": truth.astype(kind), "scale": 3.0, "title": "x"},
                     do_compression=number % 2 == 0)
    check("m.mat", truth)
scipy_io.savemat(folder / "v4.mat", {"loops": truth}, format="4")
check("v4.mat", truth)
scipy_io.savemat(folder / "s.mat", {"loops": sparse.csc_matrix(truth.astype(float))})
check("s.mat", truth, dtype="bool")
scipy_io.savemat(folder / "n.mat", {"scores": sparse.csc_matrix(truth * 0.25)})
check("n.mat", truth * 0.25, dtype="float64")
scipy_io.savemat(folder / "two.mat", {"a": truth, "b": truth.T})
check("two.mat", truth.T, "--variable", "b")
scipy_io.savemat(folder / "t.mat", {"a": truth.T, "truth": truth})
check("t.mat", truth)

# Version 7.3 in the layout of MATLAB: columns are rows of HDF5, sparse matrices are groups.
with h5py.File(folder / "h.mat", "w", userblock_size=512) as file:
    file["loops"] = truth.T.astype("u1")
    file["loops"].attrs["MATLAB_class"] = numpy.bytes_("logical")
    file["text"] = numpy.zeros((1, 4), "u2")
    file["text"].attrs["MATLAB_class"] = numpy.bytes_("char")
with open(folder / "h.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
check("h.mat", truth, dtype="bool")
with h5py.File(folder / "hs.mat", "w") as file:
    group, packed = file.create_group("loops"), sparse.csc_matrix(truth)
    group.attrs["MATLAB_class"], group.attrs["MATLAB_sparse"] = numpy.bytes_("double"), numpy.uint64(2)
    group["data"], group["ir"], group["jc"] = packed.data.astype(float), packed.indices, packed.indptr
check("hs.mat", truth)

# Programs read the result.
check("s.mat", truth)
report = json.loads(support.evaluated(folder / "o.npy"))
assert report["frames"]["query"] == 2, report
support.named(folder / "s.mat", "mat.py")

support.refused(convert(folder / "two.mat", "-o", folder / "x.npy"), 2, "--variable")
support.refused(convert(folder / "m.mat", "-o", folder / "x.npy", "--variable", "b"), 2, "no matrix b")
support.refused(convert(folder / "m.mat", "-o", folder / "o.npy"), 2, "--force")
support.refused(convert(folder / "none.mat", "-o", folder / "x.npy"), 3, "none.mat")
support.refused(convert(folder / "m.mat", "-o", folder / "none/x.npy"), 3, "No such file")
for start in (b"# Created by Octave 7.3.0, Sat Nov 28 12:00:00 2026 UTC <me@there>\n# name: A\n", b"Octave-1-L\0"):
    (folder / "octave.mat").write_bytes(start)
    support.refused(convert(folder / "octave.mat", "-o", folder / "x.npy"), 4, "save -v7")
scipy_io.savemat(folder / "c.mat", {"loops": truth * 1j})
support.refused(convert(folder / "c.mat", "-o", folder / "x.npy"), 4, "real numbers")
scipy_io.savemat(folder / "e.mat", {"scale": 3.0, "title": "x"})
support.refused(convert(folder / "e.mat", "-o", folder / "x.npy"), 4, "no matrix")
whole = (folder / "s.mat").read_bytes()
for bad in (b"", b"query,reference\n0,1\n", whole[:len(whole) // 2], b"\x89HDF\r\n\x1a\n" + bytes(99)):
    (folder / "bad.mat").write_bytes(bad)
    support.refused(convert(folder / "bad.mat", "-o", folder / "x.npy"), 4, "bad.mat")
assert not (folder / "x.npy").exists()
