#!/usr/bin/env python3
"""OpenFABMAP's YAML as .npy files, and databases as YAML: openfabmap.py SOURCE BIN."""
import gzip

import support

numpy, image = support.packages("numpy", "PIL.Image")
folder, convert = support.folder, support.converter("openfabmap.py")


def node(name, rows, columns, kind, values):
    return (f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: {kind}\n"
            f"   data: [ {values} ]\n")


def converted(text, *more):
    (folder / "m.yml").write_text(text)
    return convert(folder / "m.yml", "-o", folder / "m.npy", "--force", *more)


def check(expected):
    found = numpy.load(folder / "m.npy")
    assert found.dtype == expected.dtype and numpy.array_equal(found, expected, equal_nan=True), found


start = "%YAML:1.0\n---\n"
support.good(converted(start + node("Vocabulary", 2, 3, "f", "1., -2.5e-05, .Nan,\n       -.Inf, .5, 0.1")))
check(numpy.array([[1, -2.5e-05, numpy.nan], [-numpy.inf, 0.5, 0.1]], "f4"))
support.good(converted(start + node("VocabTrainData", 1, 2, "u", "7, 255")))
check(numpy.array([[7, 255]], "u1"))
several = start + "settings: { list: [ 1, 2 ] }\n" + node("Other", 1, 1, "d", "3.") + node(
    "ChowLiuTree", 4, 1, "d", "0., 0.5, 0.5, 0.1")
support.good(converted(several, "--node", "ChowLiuTree"))
check(numpy.array([[0], [0.5], [0.5], [0.1]]))
(folder / "m.yml.gz").write_bytes(gzip.compress(several.encode()))
support.good(convert(folder / "m.yml.gz", "-o", folder / "z.npy", "--node", "Other"))
support.refused(converted(several), 2, "Other, ChowLiuTree")
for bad in ("", "nonsense", several.replace("cols: 1", "cols: 2"), several.replace("0.1", "x")):
    support.refused(converted(bad, "--node", "ChowLiuTree"), 4, "m.yml")
(folder / "cut.yml.gz").write_bytes((folder / "m.yml.gz").read_bytes()[:-9])
support.refused(convert(folder / "cut.yml.gz", "-o", folder / "x.npy"), 4, "is damaged")
support.refused(convert(folder / "none.yml", "-o", folder / "x.npy"), 3, "none.yml")

# A database, its YAML, and a database imported from it: the same words and tree.
for name, seed in (("pre", 1), ("walk", 2)):
    (folder / name).mkdir()
    for frame in range(6):
        noise = numpy.random.default_rng(10 * seed + frame).integers(0, 255, (24, 32), "u1")
        image.fromarray(noise).resize((320, 240)).save(folder / name / f"{frame}.png")
train = (support.programs / "vpr-train", "fabmap", "--features", "sift", "--quiet")
support.good(support.run(*train, "--pretrain", folder / "pre", "--train", folder / "walk", "--words", "20", "-o",
                         folder / "d.vprdb"))
yaml = folder / "yaml"
support.good(convert(folder / "d.vprdb", "-o", yaml))
flags = {"vocabulary": "--vocabulary", "tree": "--tree", "bow-pretrain": "--pretrain", "bow-train": "--train"}
arrays = []
for name, flag in flags.items():
    support.good(convert(yaml / f"{name}.yml", "-o", folder / f"{name}.npy"))
    arrays += [flag, folder / f"{name}.npy"]
support.good(support.run(*train, "--from-openfabmap", *arrays, "-o", folder / "e.vprdb"))
for name in "vocabulary.npy", "tree.npy", "places.npy", "place_offsets.npy", "pretrain.npy", "index.npy":
    assert (folder / "d.vprdb" / name).read_bytes() == (folder / "e.vprdb" / name).read_bytes(), name
refused = support.run(*train, "--from-openfabmap", *arrays[:-1], yaml / "bow-train.yml", "-o", folder / "f.vprdb")
assert refused.returncode == 2 and "scripts/convert/openfabmap.py" in refused.stderr, refused
