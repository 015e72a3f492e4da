#!/usr/bin/env python3
"""Declares a synthetic recording wrongly, with errors drawn from a seed.

    scripts/redeclare_recording.py RECORDING SEED OUT

RECORDING: folder with recording.json, scene.gltf and a truth.json whose frames have world_from_sonar. OUT: a new
folder with the same images, SYNTHETIC as they are. Range and azimuth axes, every pose and the mock-up are declared
wrongly there, and its truth.json holds the errors, so that scripts/judge_calibration.py can judge a calibration.
"""

import json
import math
import pathlib
import random
import sys

NODE = "mockup"
# Standard deviations of the errors.
RANGE_OFFSET_M = 0.02
RANGE_SCALE = 0.008
AZIMUTH_OFFSET_DEG = 0.5
AZIMUTH_SCALE = 0.01
POSITION_M = 0.01
ANGLE_DEG = 0.5
NODE_M = 0.04
NODE_YAW_DEG = 2.5


def product(p, q):
    """Product of two quaternions, w x y z."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e)


def small_rotation(errors_deg):
    half = [math.radians(error) / 2 for error in errors_deg]
    return (math.sqrt(1 - sum(h * h for h in half)), *half)


def node_transform(scene, node, moved, yaw_deg):
    """Moves a node, in a file whose y axis is up: world X, Y, Z are x, -z, y."""
    mesh = scene["meshes"][scene["nodes"][node]["mesh"]]
    boxes = [scene["accessors"][p["attributes"]["POSITION"]] for p in mesh["primitives"]]
    low = [min(box["min"][k] for box in boxes) for k in range(3)]
    high = [max(box["max"][k] for box in boxes) for k in range(3)]
    x, _, z = [(a + b) / 2 for a, b in zip(low, high)]
    cosine, sine = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    scene["nodes"][node]["translation"] = [x - cosine * x - sine * z + moved[0], 0.0, z + sine * x - cosine * z - moved[1]]
    scene["nodes"][node]["rotation"] = [0.0, math.sin(math.radians(yaw_deg) / 2), 0.0, math.cos(math.radians(yaw_deg) / 2)]


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    source, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[3])
    draw = random.Random(int(sys.argv[2])).gauss
    recording, truth, scene = [json.loads((source / name).read_text(encoding="utf-8"))
                               for name in ("recording.json", "truth.json", "scene.gltf")]
    if truth.get("geometry") or any(key.endswith("_declared_minus_true") for key in truth):
        sys.exit(f"{source}: its sonar or scene is declared wrongly already, expected a recording that is not")
    geometry = {"range_offset_m": draw(0, RANGE_OFFSET_M), "range_scale": 1 + draw(0, RANGE_SCALE),
                "azimuth_offset_deg": draw(0, AZIMUTH_OFFSET_DEG), "azimuth_scale": 1 + draw(0, AZIMUTH_SCALE)}
    sonar = recording["sonar"]
    for key in ("range_min_m", "range_max_m"):
        sonar[key] = (sonar[key] - geometry["range_offset_m"]) / geometry["range_scale"]
    sonar["beam_azimuth_deg"] = [(azimuth - geometry["azimuth_offset_deg"]) / geometry["azimuth_scale"]
                                 for azimuth in sonar["beam_azimuth_deg"]]
    for frame, true in zip(recording["frames"], truth["frames"]):
        pose = true["world_from_sonar"]
        frame["world_from_sonar"] = {
            "position_m": [p + draw(0, POSITION_M) for p in pose["position_m"]],
            "quaternion_wxyz": product(pose["quaternion_wxyz"], small_rotation([draw(0, ANGLE_DEG) for _ in range(3)]))}
    moved = [draw(0, NODE_M), draw(0, NODE_M)]
    yaw_deg = draw(0, NODE_YAW_DEG)
    node_transform(scene, [n["name"] for n in scene["nodes"]].index(NODE), moved, yaw_deg)
    truth["geometry"] = geometry
    truth[f"{NODE}_declared_minus_true"] = {"x_m": moved[0], "y_m": moved[1], "yaw_deg": yaw_deg}
    out.mkdir()
    for name, content in (("recording.json", recording), ("truth.json", truth), ("scene.gltf", scene)):
        (out / name).write_text(json.dumps(content, indent=1), encoding="utf-8")
    for image in source.glob("frame_*.png"):
        (out / image.name).write_bytes(image.read_bytes())


if __name__ == "__main__":
    main()
