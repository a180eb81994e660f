#!/usr/bin/env python3
"""Mask images as matrices: mask.py SOURCE BIN."""
import support

numpy, image = support.packages("numpy", "PIL.Image")
folder, convert = support.folder, support.converter("mask.py")
mask = numpy.array([[255, 1, 0], [0, 254, 255]], "u1")
image.fromarray(mask).save(folder / "m.png")
image.fromarray(numpy.stack([mask] * 3, 2)).save(folder / "rgb.bmp")
for name in "m.png", "rgb.bmp":
    support.good(convert(folder / name, "-o", folder / "g.npz", "--force"))
    support.good(support.run(support.programs / "vpr-eval", "convert", folder / "g.npz", "--to", "pairs",
                             "-o", folder / "pairs.csv", "--force"))
    assert (folder / "pairs.csv").read_text() == (
        "query,reference,label\n0,0,same\n0,1,ignore\n1,1,ignore\n1,2,same\n"), name
support.refused(convert(folder / "m.png", "-o", folder / "g.npy"), 2, "gray")
image.fromarray(numpy.where(mask == 255, 255, 0).astype("u1")).save(folder / "b.png")
support.good(convert(folder / "b.png", "-o", folder / "g.npy"))
assert (numpy.load(folder / "g.npy") == (mask == 255)).all()
image.fromarray(mask == 255).save(folder / "one.png")
support.good(convert(folder / "one.png", "-o", folder / "g.npy", "--force"))
assert (numpy.load(folder / "g.npy") == (mask == 255)).all()
support.named(folder / "m.png", "mask.py")
image.fromarray((mask == 255).astype("u1")).save(folder / "01.png")
support.refused(convert(folder / "01.png", "-o", folder / "x.npz"), 4, "only 0 and 1")

image.fromarray(mask).save(folder / "m.jpg")
support.refused(convert(folder / "m.jpg", "-o", folder / "x.npz"), 4, "JPEG")
image.fromarray(mask).save(folder / "m.webp")
support.refused(convert(folder / "m.webp", "-o", folder / "x.npz"), 4, "WEBP")
support.refused(convert(folder / "m.png", "-o", folder / "m.png", "--force"), 2, "is the source")
image.fromarray(mask.astype("u2") << 8).save(folder / "deep.png")
support.refused(convert(folder / "deep.png", "-o", folder / "x.npz"), 4, "8 bits")
(folder / "cut.png").write_bytes((folder / "m.png").read_bytes()[:50])
support.refused(convert(folder / "cut.png", "-o", folder / "x.npz"), 4, "cut.png")
support.refused(convert(folder / "none.png", "-o", folder / "x.npz"), 3, "none.png")
