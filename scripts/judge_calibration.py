#!/usr/bin/env python3
"""Compares a calibration with the truth of a synthetic recording.

    scripts/judge_calibration.py RECORDING CALIBRATED

RECORDING: folder with truth.json. CALIBRATED: output folder of `sonarcal calibrate` or `sonarcal fit`. Prints what
the calibration found beside the truth: noise, pulse, mirrors, geometry, objects, poses, and curves where at least
90 pixels show them. Last comes the chi-square of the errors of all placements together (geometry, objects, poses),
with their standard errors and correlations: it is about their number if the standard errors are right.
"""

import json
import math
import pathlib
import sys

import numpy

POSE = ("x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg")
LEAST_PIXELS = 90


def pose_values(frame):
    """True x, y, z in m, roll, pitch, yaw in degrees, named as in fit.json."""
    w, x, y, z = frame["world_from_sonar"]["quaternion_wxyz"]
    ahead = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
    yaw = math.atan2(-ahead[0], ahead[1])
    pitch = math.asin(ahead[2])
    roll = math.atan2(-2 * (x * z - w * y), 1 - 2 * (x * x + y * y))
    return dict(zip(POSE, (*frame["world_from_sonar"]["position_m"], *map(math.degrees, (roll, pitch, yaw)))))


def true_values(truth):
    """True values by the names of fit.json."""
    values = {f"geometry.{name}": value for name, value in truth.get("geometry", {}).items() if name != "meaning"}
    for key, moved in truth.items():
        if key.endswith("_declared_minus_true"):
            node = key.removesuffix("_declared_minus_true")
            values.update({f"object.{node}.{name}": -value for name, value in moved.items()})
    values["receiver.noise_db"] = truth["noise_level_db"]
    values["pulse.length_m"] = truth["cell"]["range_half_power_m"]
    for material, pressure in (truth.get("reflection_pressure") or {}).items():
        values[f"mirror.{material}.loss_db"] = -20 * math.log10(abs(pressure))
    for index, frame in enumerate(truth["frames"]):
        values.update({f"pose.{index}.{name}": value for name, value in pose_values(frame).items()})
    return values


def off(parameter, value):
    error = parameter["value"] - value
    return math.remainder(error, 360.0) if parameter["name"].endswith("deg") else error


def judge_values(parameters, values):
    print(f"{'value':32} {'found':>9} {'sigma':>7} {'truth':>9} {'off':>8} {'sigmas':>6}")
    for parameter in parameters:
        name = parameter["name"]
        declared = name.startswith(("geometry.", "object."))
        if name.startswith("pose.") or parameter["sigma"] is None or not (declared or name in values):
            continue
        error = off(parameter, values.get(name, 1.0 if "scale" in name else 0.0))
        print(f"{name:32} {parameter['value']:9.4f} {parameter['sigma']:7.4f} {parameter['value'] - error:9.4f} "
              f"{error:8.4f} {error / parameter['sigma']:6.1f}")


def judge_poses(parameters, values):
    for component in POSE:
        of = [p for p in parameters if p["name"].startswith("pose.") and p["name"].endswith("." + component)]
        of = [p for p in of if p["name"] in values]
        if not of:
            continue
        after = [off(p, values[p["name"]]) for p in of]
        before = [off({"name": p["name"], "value": p["initial"]}, values[p["name"]]) for p in of]
        print(f"poses, {component:9} rms error {rms(before):.4f} before, {rms(after):.4f} after")


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def interpolated(at, values, x):
    above = next(i for i, a in enumerate(at) if a >= x)
    part = (x - at[above - 1]) / (at[above] - at[above - 1])
    return (1 - part) * values[above - 1] + part * values[above]


def judge_curves(fit, truth):
    coverage = truth["incidence_coverage"]
    edges = coverage["bin_edges_deg"]
    for curve in fit["curves"]:
        material = curve["material"]
        if material not in coverage["pixels"]:
            continue
        true = truth["gsab"][material]
        worst = (0.0, None)
        for low, high, pixels in zip(edges, edges[1:], coverage["pixels"][material]):
            if pixels < LEAST_PIXELS:
                continue
            angle = 0.5 * (low + high)
            power = (true["A"] * math.exp(-angle**2 / (2 * true["B"]**2))
                     + true["C"] * math.cos(math.radians(angle))**true["D"]
                     + true["E"] * math.exp(-angle**2 / (2 * true["F"]**2)))
            found = interpolated(curve["incidence_deg"], curve["backscatter_db"], angle)
            worst = max(worst, (abs(found - 10 * math.log10(power)), angle))
        if worst[1] is not None:
            print(f"curve of {material:10} off by up to {worst[0]:.2f} dB, at {worst[1]:.1f} deg")


def judge_standard_errors(fit, values):
    found = {p["name"]: p for p in fit["parameters"] if p["sigma"] is not None}
    names = fit["correlation"]["names"]
    kept = [k for k, name in enumerate(names)
            if name in found and (name in values or name.startswith("object."))
            and name.startswith(("geometry.", "object.", "pose."))]
    if not kept:
        return
    placements = [found[names[k]] for k in kept]
    errors = numpy.array([off(p, values.get(p["name"], 0.0)) / p["sigma"] for p in placements])
    correlation = numpy.array(fit["correlation"]["matrix"])[numpy.ix_(kept, kept)]
    print(f"errors of {len(kept)} placements over their standard errors: rms {rms(errors):.2f}, "
          f"chi-square {errors @ numpy.linalg.solve(correlation, errors):.0f}")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    recording, calibrated = map(pathlib.Path, sys.argv[1:])
    truth = json.loads((recording / "truth.json").read_text(encoding="utf-8"))
    fit = json.loads((calibrated / "fit.json").read_text(encoding="utf-8"))
    values = true_values(truth)
    judge_values(fit["parameters"], values)
    judge_poses(fit["parameters"], values)
    judge_curves(fit, truth)
    judge_standard_errors(fit, values)


if __name__ == "__main__":
    main()
