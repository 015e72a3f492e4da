"""A recording's archive as NumPy reads it, as JSON.

    read_npz.py FILE
"""

import json
import sys

import numpy


def plain(array):
    """Nested lists; NaN becomes None."""
    if array.dtype.kind == "f":
        return numpy.where(numpy.isnan(array), None, array.astype(object)).tolist()
    return array.tolist()


with numpy.load(sys.argv[1], allow_pickle=False) as archive:
    arrays = {
        name: {"dtype": str(archive[name].dtype), "shape": list(archive[name].shape), "values": plain(archive[name])}
        for name in archive.files
        if name != "recording"
    }
    json.dump({"arrays": arrays, "recording": json.loads(archive["recording"].item())}, sys.stdout)
