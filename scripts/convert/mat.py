#!/usr/bin/python3
"""Write a matrix of a MAT-file as a .npy file.

  mat.py loops.mat -o loops.npy
  mat.py results.mat --variable scores -o scores.npy

Reads full and sparse matrices of numbers or logical values, of MAT-files of version 4 to 7
(python3-scipy) and 7.3 (python3-h5py). Rows stay rows. By default the matrix is the only one in
the file, or the one named truth; scalars are ignored.
"""
import io

import common

numpy = common.need("numpy", "python3-numpy")

KINDS = {"double", "single", "logical", "sparse", *(f"{sign}int{bits}" for sign in ("", "u")
                                                    for bits in (8, 16, 32, 64))}


def choose(path, shapes, wanted):
    """The name of the matrix; `shapes` has the shape of each."""
    if wanted is not None:
        if wanted not in shapes:
            raise common.Refusal(common.USAGE, f"{path}: has no matrix {wanted}; it has "
                                               f"{', '.join(shapes) or 'none'}")
        return wanted
    matrices = [name for name, shape in shapes.items() if numpy.prod(shape) != 1]
    if "truth" in matrices:
        return "truth"
    if len(matrices) != 1:
        raise common.Refusal(common.USAGE if matrices else common.DATA,
                             f"{path}: has {', '.join(matrices)}; choose one with --variable"
                             if matrices else f"{path}: has no matrix of numbers")
    return matrices[0]


def full(sparse):
    """A sparse matrix as an array: of bool where it has only zeros and ones."""
    only_ones = numpy.isin(sparse.data, (0, 1)).all()
    return (sparse.astype(bool) if only_ones else sparse).toarray()


def read_hdf5(path, wanted):
    h5py = common.need("h5py", "python3-h5py")
    with h5py.File(path) as file:
        def kind(name):
            return bytes(file[name].attrs.get("MATLAB_class", b"")).decode()

        def shape(node):
            if "MATLAB_sparse" in node.attrs:
                return int(node.attrs["MATLAB_sparse"]), len(node["jc"]) - 1
            return node.shape
        nodes = {name: file[name] for name in file if kind(name) in KINDS and (
            isinstance(file[name], h5py.Dataset) or "MATLAB_sparse" in file[name].attrs)}
        shapes = {name: shape(node) for name, node in nodes.items() if len(shape(node)) == 2}
        name = choose(path, shapes, wanted)
        if isinstance(nodes[name], h5py.Group):
            scipy_sparse = common.need("scipy.sparse", "python3-scipy")
            parts = [numpy.array(nodes[name][part]) if part in nodes[name] else numpy.zeros(0)
                     for part in ("data", "ir", "jc")]
            return full(scipy_sparse.csc_matrix(tuple(parts), shape=shapes[name]))
        values = numpy.array(nodes[name]).T  # MATLAB's columns are HDF5's rows
        return values.astype(bool) if kind(name) == "logical" else values


def read_mat(path, wanted):
    scipy_io = common.need("scipy.io", "python3-scipy")
    shapes = {name: shape for name, shape, kind in scipy_io.whosmat(path, appendmat=False)
              if kind in KINDS and len(shape) == 2}
    name = choose(path, shapes, wanted)
    values = scipy_io.loadmat(path, appendmat=False, variable_names=[name])[name]
    return full(values) if hasattr(values, "toarray") else values


def convert(arguments):
    path = arguments.source
    with open(path, "rb") as file:
        start = file.read(520)
    # Octave's own formats, which save writes without an option.
    if start.startswith((b"# Created by Octave", b"Octave-1-")):
        raise common.Refusal(common.DATA, f"{path}: is in Octave's own format. Save it in Octave "
                                          f"with: save -v7 {path.stem}.mat NAME")
    is_hdf5 = start.startswith((b"\x89HDF\r\n", b"MATLAB 7.3"))
    try:
        values = (read_hdf5 if is_hdf5 else read_mat)(path, arguments.variable)
    except (common.Refusal, MemoryError):
        raise
    except Exception as error:  # the libraries raise many kinds for damaged files
        raise common.Refusal(common.DATA, f"{path}: is not a readable MAT-file ({error}). If Octave wrote a "
                                          "sparse matrix, save full(NAME)") from None
    if values.dtype.kind not in "biuf":
        raise common.Refusal(common.DATA, f"{path}: the matrix is not of real numbers")
    output = io.BytesIO()
    numpy.save(output, numpy.ascontiguousarray(values.astype(values.dtype.newbyteorder("<"))))
    common.write(arguments, output.getvalue())


parser = common.parser(__doc__, "FILE.mat", "FILE.npy")
parser.add_argument("--variable", metavar="NAME", help="the matrix (default: the only one)")
common.run(parser.parse_args(), convert)
