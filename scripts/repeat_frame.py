#!/usr/bin/env python3
"""Makes a recording that shows one frame eight times, and a pose for each: for several speckled samples of one frame.

usage: scripts/repeat_frame.py RECORDING FRAME POSES OUT

RECORDING is a recording folder, FRAME a number in it, POSES a poses.json whose first pose is taken. OUT gets
real/recording.json with the frame, and poses.json.
"""

import json
import pathlib
import shutil
import sys

TIMES = 8


def main():
    """The program."""
    if len(sys.argv) != 5:
        sys.exit("usage: scripts/repeat_frame.py RECORDING FRAME POSES OUT")
    recording, frame, poses, out = (pathlib.Path(sys.argv[1]), int(sys.argv[2]), pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4]))
    description = json.loads((recording / "recording.json").read_text(encoding="utf-8"))
    shown = description["frames"][frame]
    pose = json.loads(poses.read_text(encoding="utf-8"))["poses"][0]["world_from_sonar"]
    (out / "real").mkdir(parents=True)
    shutil.copyfile(recording / shown["file"], out / "real" / shown["file"])
    description["frames"] = [shown] * TIMES
    (out / "real" / "recording.json").write_text(json.dumps(description, indent=1) + "\n", encoding="utf-8")
    posed = {"format": "sonar-poses/1", "poses": [{"world_from_sonar": pose}] * TIMES}
    (out / "poses.json").write_text(json.dumps(posed, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
