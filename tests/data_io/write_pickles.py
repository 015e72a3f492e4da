"""Frames in the form of NeuSIS as NumPy pickles them, with every protocol.

    write_pickles.py FOLDER

Frame K.pkl has protocol K. All hold the same image and pose. Further frames: arrays in the order of Fortran,
big-endian, not contiguous, and read-only. Other values of each frame are left out by the reader.
"""

import json
import pathlib
import pickle
import sys

import numpy

folder = pathlib.Path(sys.argv[1])
image = numpy.arange(12, dtype="u1").reshape(4, 3)
pose = numpy.eye(4, dtype="f4")
pose[:3, 3] = [1, 2, 3]
frozen = image.copy()
frozen.flags.writeable = False

frames = [(protocol, image, pose) for protocol in range(6)]
for protocol in (2, 4, 5):
    frames += [(protocol, numpy.asfortranarray(image), pose.astype(">f8")),
               (protocol, numpy.repeat(image, 2, axis=1)[:, ::2], numpy.asfortranarray(pose)),
               (protocol, frozen, pose)]
for number, (protocol, an_image, a_pose) in enumerate(frames):
    state = {"PoseSensor": a_pose, "ImagingSonar": an_image, "t": 0.5, "DVLSensor": numpy.zeros(7), "name": "auv0",
             "empty": numpy.zeros((0, 3)), "bytes": b"", "bytearray": bytearray(b"\0\xff"), "none": bytearray()}
    (folder / f"{number}.pkl").write_bytes(pickle.dumps(state, protocol=protocol))
(folder / "refused.pkl").write_bytes(pickle.dumps({"ImagingSonar": numpy.float32(1)}))
(folder / "Config.json").write_text(json.dumps({"RangeMin": 1, "RangeMax": 5, "Azimuth": 30}))
print(len(frames))
