#!/usr/bin/python3
"""Write a matrix of OpenFABMAP's YAML as a .npy file, or a database as such YAML.

  openfabmap.py vocabulary.yml.gz -o vocabulary.npy
  openfabmap.py fabmap.vprdb -o openfabmap

A file of cv::FileStorage, plain or compressed by gzip, has the node Vocabulary (words x
dimensions), ChowLiuTree (4 x words), BOWImageDescs (frames x words) or VocabTrainData (descriptors
x dimensions). vpr-train fabmap --from-openfabmap and vpr-query read the .npy files. A
database (.vprdb) is written to a new folder: vocabulary.yml, tree.yml, bow-pretrain.yml and
bow-train.yml. Needs python3-numpy.
"""
import gzip
import io
import json
import re

import common

numpy = common.need("numpy", "python3-numpy")

TYPES = {"u": "u1", "c": "i1", "w": "<u2", "s": "<i2", "i": "<i4", "f": "<f4", "d": "<f8"}
MATRIX = re.compile(r'^(\w+): !!opencv-matrix\s+rows: (\d+)\s+cols: (\d+)\s+dt: "?(\w+)"?\s+'
                    r"data: \[([^\]]*)\]", re.MULTILINE)


def read_matrix(path, wanted):
    """The only matrix of the file, or the one named `wanted`."""
    with open(path, "rb") as file:
        is_packed = file.read(2) == b"\x1f\x8b"
    try:
        with (gzip.open if is_packed else open)(path, "rt", encoding="utf-8") as file:
            text = file.read()
    except (EOFError, UnicodeDecodeError, gzip.BadGzipFile, gzip.zlib.error):
        raise common.Refusal(common.DATA, f"{path}: is damaged") from None
    found = {match[1]: match for match in MATRIX.finditer(text)}
    if wanted is None and len(found) == 1:
        wanted = next(iter(found))
    if wanted not in found:
        names = ", ".join(found) or "none"
        raise common.Refusal(common.DATA if not found else common.USAGE,
                             f"{path}: choose a matrix of OpenCV's YAML with --node; it has {names}")
    rows, columns, kind, values = found[wanted].groups()[1:]
    values = re.sub(r"\.(?=nan|inf)", "", values, flags=re.IGNORECASE)
    try:
        matrix = numpy.array(values.replace("\n", " ").split(","), dtype=float)
        return matrix.astype(TYPES[kind]).reshape(int(rows), int(columns))
    except (KeyError, ValueError):
        raise common.Refusal(common.DATA, f"{path}: the values of {wanted} do not fit its {rows} x "
                                          f"{columns} of type {kind}") from None


def matrix_text(name, matrix):
    kind = {"float32": "f", "float64": "d"}[matrix.dtype.name]
    values = ", ".join(map(str, matrix.ravel()))
    return (f"%YAML:1.0\n---\n{name}: !!opencv-matrix\n   rows: {matrix.shape[0]}\n"
            f"   cols: {matrix.shape[1]}\n   dt: {kind}\n   data: [ {values} ]\n")


def word_matrix(database, name, offsets, words):
    """frames x words: 1 for each word that a frame shows."""
    shown, offsets = (numpy.load(database / f"{part}.npy") for part in (name, offsets))
    matrix = numpy.zeros((len(offsets) - 1, words), "f4")
    frames = numpy.repeat(numpy.arange(len(matrix)), numpy.diff(offsets.astype(int)))
    matrix[frames, shown] = 1
    return matrix


def write_database(arguments):
    database = arguments.source
    if json.loads((database / "manifest.json").read_text()).get("method") != "fabmap":
        raise common.Refusal(common.USAGE, f"{database}: is not a database for FAB-MAP")
    vocabulary = numpy.load(database / "vocabulary.npy")
    if vocabulary.dtype != "f4":
        raise common.Refusal(common.USAGE, f"{database}: OpenFABMAP has no binary words")
    files = {"vocabulary.yml": ("Vocabulary", vocabulary),
             "tree.yml": ("ChowLiuTree", numpy.load(database / "tree.npy")),
             "bow-pretrain.yml": ("BOWImageDescs", word_matrix(
                 database, "pretrain", "pretrain_offsets", len(vocabulary))),
             "bow-train.yml": ("BOWImageDescs", word_matrix(
                 database, "places", "place_offsets", len(vocabulary)))}
    arguments.output.mkdir(exist_ok=arguments.force)
    for name, (node, matrix) in files.items():
        (arguments.output / name).write_text(matrix_text(node, matrix))


def convert(arguments):
    if arguments.source.is_dir():
        return write_database(arguments)
    output = io.BytesIO()
    numpy.save(output, read_matrix(arguments.source, arguments.node))
    common.write(arguments, output.getvalue())


parser = common.parser(__doc__, "FILE.yml[.gz]|DB", "FILE.npy|FOLDER")
parser.add_argument("--node", metavar="NAME", help="the matrix (default: the only one)")
common.run(parser.parse_args(), convert)
