#!/usr/bin/python3
"""Write a mask image as a ground truth matrix.

  mask.py mask.png -o ground_truth.npz

A row of the image is a query frame, a column a training frame: 255 is the same place, 0 is another
place, and values in between are ignored. A .npz file holds the matrices GThard and GTsoft as in
VPR_Tutorial; a .npy file holds one matrix, for masks without ignored pairs. JPEG and WebP images
are refused: their values may differ from the drawn ones. Needs python3-pil.
"""
import io

import common

numpy = common.need("numpy", "python3-numpy")
LOSSLESS = ("PNG", "TIFF", "BMP", "GIF", "PPM")


def convert(arguments):
    image_module = common.need("PIL.Image", "python3-pil")
    image_module.MAX_IMAGE_PIXELS = None  # a matrix of 20 000 x 20 000 is legitimate
    path = arguments.source
    try:
        with image_module.open(path) as image:
            if image.format not in LOSSLESS or "jpeg" in str(image.info.get("compression")):
                raise common.Refusal(common.DATA, f"{path}: is a {image.format}, whose values may "
                                                  "differ from the drawn ones; save the mask as PNG")
            if image.mode not in ("1", "L", "LA", "P", "RGB", "RGBA"):
                raise common.Refusal(common.DATA, f"{path}: has more than 8 bits per channel")
            mask = numpy.array(image.convert("L"))
    except (OSError, SyntaxError, ValueError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise common.Refusal(common.DATA, f"{path}: cannot decode image") from None
    if mask.max(initial=0) == 1:
        raise common.Refusal(common.DATA, f"{path}: has only 0 and 1; multiply it by 255, the value of the same place")
    output = io.BytesIO()
    if arguments.output.suffix == ".npz":
        numpy.savez_compressed(output, GThard=mask.T == 255, GTsoft=mask.T > 0)
    elif numpy.isin(mask, (0, 255)).all():
        numpy.save(output, mask == 255)
    else:
        raise common.Refusal(common.USAGE, f"{path}: has gray pixels, which are ignored pairs; "
                                           "write a .npz file")
    common.write(arguments, output.getvalue())


common.run(common.parser(__doc__, "IMAGE", "FILE.npz").parse_args(), convert)
