"""The frame of frame_benchmark.cc in plain NumPy, as a researcher would write it: whole arrays, one core.

    numpy_frame.py DIR      DIR: what sonarcal_frame_hits wrote

The hits (range, normal, direction and material of each ray) are given. The time is that of all further steps:
incidence, GSAB, transmission loss, level, errors of range and azimuth, bins, polar and fan image. Written from
the paper's formulas alone, so its image is a second opinion of the program's: at least 99.9 % of the pixels
are within one grey level of it. With errors the two draw different numbers; over several frames the
difference of the means, squared, over its variance must average what Student's t would. Exits with 1 where
the two disagree.
"""

import json
import pathlib
import sys
import time

import numpy as np

ROUNDS = 8


def beam_edges(azimuth_rad):
    """Edges midway between the beams' centres, the outer two as far out as the next inner ones."""
    middle = 0.5 * (azimuth_rad[1:] + azimuth_rad[:-1])
    return np.concatenate([[2 * azimuth_rad[0] - middle[0]], middle, [2 * azimuth_rad[-1] - middle[-1]]])


def fan_lookup(frame, edges):
    """For each pixel of the fan, the polar pixel it lies in; the number of polar pixels outside. Once a sonar."""
    fan = frame["fan"]
    x = fan["x_min_m"] + (np.arange(fan["cols"]) + 0.5) * fan["pixel_m"]
    y = fan["y_max_m"] - (np.arange(fan["rows"]) + 0.5) * fan["pixel_m"]
    x, y = np.meshgrid(x, y)
    range_bin = np.floor((np.hypot(x, y) - frame["range_min_m"]) / frame["range_bin_m"]).astype(int)
    beam = np.searchsorted(edges, np.arctan2(x, y), side="right") - 1
    beams = len(edges) - 1
    inside = (range_bin >= 0) & (range_bin < frame["range_bins"]) & (beam >= 0) & (beam < beams)
    return np.where(inside, range_bin * beams + beam, frame["range_bins"] * beams)


def polar_image(frame, edges, hits, rng=None):
    """The paper's Eqs. 11 and 19 to 28; with `rng`, errors of range and azimuth."""
    range_m, direction, normal, material = hits
    beams = len(edges) - 1
    azimuth = np.arctan2(direction[:, 0], direction[:, 1])
    own_beam = np.searchsorted(edges, azimuth, side="right") - 1
    own_beam = np.clip(own_beam, 0, beams - 1)
    rays_of_beam = np.bincount(own_beam, minlength=beams)

    hit = (range_m >= frame["range_min_m"]) & (range_m < frame["range_max_m"])
    r = range_m[hit]
    azimuth = azimuth[hit]
    cosine = np.abs(np.einsum("ij,ij->i", direction[hit], normal[hit])).clip(0, 1)
    incidence = np.degrees(np.arccos(cosine))
    a, b, c, d, e, f = np.asarray(frame["gsab"], dtype=np.float32)[material[hit]].T
    gsab = (a * np.exp(-incidence**2 / (2 * b**2)) + c * cosine**d
            + e * np.exp(-incidence**2 / (2 * f**2)))
    loss_db = 20 * np.log10(r) + frame["absorption_db_per_m"] * r
    snr_db = frame["source_level_db"] - 2 * loss_db + 10 * np.log10(gsab)
    level = (snr_db - frame["db_min"]) / (frame["db_max"] - frame["db_min"])
    level = level / rays_of_beam[own_beam[hit]]

    if rng is not None:
        jitter = frame["jitter"]
        growth = np.sqrt(1 + (r / jitter["reference_range_m"]) ** 2)
        growth = growth / np.sqrt(frame["frequency_hz"] / jitter["reference_frequency_hz"])
        errors = rng.standard_normal((2, len(r)), dtype=np.float32)
        r = r + errors[0] * growth * jitter["sigma_range_m"]
        azimuth = azimuth + errors[1] * growth * np.radians(jitter["sigma_azimuth_deg"])
    range_bin = np.floor((r - frame["range_min_m"]) / frame["range_bin_m"]).astype(int)
    beam = np.searchsorted(edges, azimuth, side="right") - 1
    seen = (range_bin >= 0) & (range_bin < frame["range_bins"]) & (beam >= 0) & (beam < beams)
    pixel = range_bin[seen] * beams + beam[seen]
    total = np.bincount(pixel, weights=level[seen], minlength=frame["range_bins"] * beams)
    image = np.rint(np.clip(total, 0, 1) * frame["full_scale"])
    return image.reshape(frame["range_bins"], beams)


def fan_image(polar, lookup):
    return np.append(polar.ravel(), 0)[lookup]


def share_within(name, ours, theirs):
    lit = (ours > 0) | (theirs > 0)
    share = np.mean(np.abs(ours - theirs)[lit] <= 1)
    print(f"{name}: {100 * share:.3f} % of the {lit.sum()} pixels that are not black lie within one grey level of "
          f"the program's (limit 99.9 %)")
    return share >= 0.999


def means_agree(frame, ours, theirs):
    """Mean square of Student's t of two samples' means, over the pixels that never reach black or white."""
    count = len(ours)
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    variance = 0.5 * (ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1))
    both = np.concatenate([ours, theirs])
    used = (both.min(axis=0) > 0) & (both.max(axis=0) < frame["full_scale"]) & (variance > 0)
    square = (ours.mean(axis=0) - theirs.mean(axis=0))[used] ** 2 / (2 * variance[used] / count)
    degrees = 2 * (count - 1)
    expected = degrees / (degrees - 2)
    print(f"with errors: mean square of t {square.mean():.3f} over {used.sum()} pixels, "
          f"expected {expected:.3f} (limits -10 %, +10 %)")
    return abs(square.mean() / expected - 1) <= 0.1


def main(folder):
    frame = json.loads((folder / "frame.json").read_text())
    frame["range_bin_m"] = (frame["range_max_m"] - frame["range_min_m"]) / frame["range_bins"]
    hits = [np.load(folder / f"{name}.npy") for name in ("range_m", "direction", "normal", "material")]
    edges = beam_edges(np.asarray(frame["beam_azimuth_rad"]))
    lookup = fan_lookup(frame, edges)

    polar = polar_image(frame, edges, hits)
    good = share_within("polar", polar, np.load(folder / "polar.npy"))
    good &= share_within("fan", fan_image(polar, lookup), np.load(folder / "fan.npy"))

    rng = np.random.default_rng(1)
    seconds, cpu_seconds, noisy = [], [], []
    for _ in range(ROUNDS):
        began, cpu_began = time.perf_counter(), time.process_time()
        polar = polar_image(frame, edges, hits, rng)
        fan_image(polar, lookup)
        seconds.append(time.perf_counter() - began)
        cpu_seconds.append(time.process_time() - cpu_began)
        noisy.append(polar)
    good &= means_agree(frame, noisy, [np.load(folder / f"noisy_{i}.npy") for i in range(ROUNDS)])

    numpy_s, numpy_cpu_s = float(np.median(seconds)), float(np.median(cpu_seconds))
    print(f"NumPy {np.__version__}, hits given: {1e3 * numpy_s:.0f} ms a frame of {len(hits[0])} rays, "
          f"{1e3 * numpy_cpu_s:.0f} ms of one processor")
    print(f"sonarcal, rays cast too: {1e3 * frame['frame_s']:.0f} ms on all cores; NumPy takes "
          f"{numpy_s / frame['frame_s']:.1f} times as long")
    print(f"sonarcal on one thread: {1e3 * frame['frame_cpu_s']:.0f} ms of one processor; NumPy takes "
          f"{numpy_cpu_s / frame['frame_cpu_s']:.1f} times as long")
    return 0 if good else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} DIR")
    sys.exit(main(pathlib.Path(sys.argv[1])))
