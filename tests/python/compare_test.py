"""compare() against the command, compare_images() against NumPy."""

import json

import numpy as np
import pytest

import sonarcal


@pytest.mark.parametrize("options, words", [
    ({}, []),
    ({"segmentation": "otsu", "blur": (1, 1), "frames": range(1, 4), "sweep_steps": 5},
     ["--segmentation", "otsu", "--blur", "1x1", "--frames", "1:4", "--sweep-steps", "5"]),
    ({"region_range": (1, 4), "region_azimuth": "-10:10", "all_components": True, "intensity_domain": "whole"},
     ["--region-range", "1:4", "--region-azimuth=-10:10", "--all-components", "--intensity-domain", "whole"]),
])
def test_equals_the_command(world, recorded, simulated, tmp_path, options, words):
    text = world.command("compare", "--real", recorded, "--sim", simulated, "--out", tmp_path / "out", "--json",
                         "--quiet", *words)
    assert sonarcal.compare(recorded, simulated, **options) == json.loads(text)


def test_an_object_is_searched_as_the_command_does(world, recorded, simulated, tmp_path):
    text = world.command("compare", "--real", recorded, "--sim", simulated, "--out", tmp_path / "out", "--json",
                         "--quiet", "--object", "box", "--object-margin", "3x2", "--scene", world.scene_file)
    metrics = sonarcal.compare(recorded, simulated, object="box", object_margin=(3, 2), scene=world.scene_file)
    assert metrics == json.loads(text)
    assert metrics["segmentation"]["object_region"]["object"] == "box"
    assert metrics["segmentation"]["method"] == "otsu"
    largest = sonarcal.compare(recorded, simulated, object="box", scene=world.scene_file, largest_component=True)
    assert largest["segmentation"]["parameters"]["largest_component_only"]


def test_residuals_by_scene_and_drawn_floor_as_the_command(world, recorded, simulated, tmp_path):
    text = world.command("compare", "--real", recorded, "--sim", simulated, "--out", tmp_path / "out", "--json",
                         "--quiet", "--scene", world.scene_file, "--params", world.params_file)
    metrics = sonarcal.compare(sonarcal.open_recording(recorded), sonarcal.open_recording(simulated),
                               scene=world.scene_file, params=world.params_file)
    assert metrics == json.loads(text)
    assert metrics["residuals"]["by_material"]
    by_object = sonarcal.compare(recorded, simulated, scene=world.scene, params=sonarcal.Parameters(world.params_file))
    assert by_object["residuals"] == metrics["residuals"] and by_object["macro"] == metrics["macro"]
    for earlier in (tmp_path / "out" / "metrics.json", metrics, dict(metrics)):
        again = sonarcal.compare(recorded, simulated, against=earlier)
        assert again["against"]["worse"] == 0 and again["against"]["better"] == 0


def test_memory_is_as_good_as_files(world, recorded, simulated):
    from_files = sonarcal.compare(recorded, simulated)
    in_memory = sonarcal.compare(recorded, world.simulate(bits=12))
    assert [f["iou"] for f in from_files["frames"]] == [f["iou"] for f in in_memory["frames"]]
    assert from_files["macro"] == in_memory["macro"]


def test_the_scene_that_a_recording_names_holds_the_object(recorded, simulated, world):
    named = sonarcal.compare(recorded, simulated, object="box")
    given = sonarcal.compare(recorded, simulated, object="box", scene=world.scene)
    assert [frame["object_region"] for frame in named["frames"]] == [frame["object_region"] for frame in given["frames"]]
    with pytest.raises(sonarcal.UsageError, match="object needs scene"):
        own = sonarcal.recording([frame.image for frame in sonarcal.open_recording(recorded)], world.sonar,
                                 poses=world.poses, full_scale=4095.0)
        sonarcal.compare(own, own, object="box")


def test_frames_are_chosen_by_number_range_or_text(recorded, simulated):
    whole = sonarcal.compare(recorded, simulated)
    for frames, expected in (([2, 0], [2, 0]), (range(1, 3), [1, 2]), ("1:3", [1, 2]), ("3,0:2", [3, 0, 1]),
                             (np.array([0]), [0]), (np.array([0, 2]), [0, 2])):
        chosen = sonarcal.compare(recorded, simulated, frames=frames)
        assert [frame["index"] for frame in chosen["frames"]] == expected
        assert [frame["iou"] for frame in chosen["frames"]] == [whole["frames"][i]["iou"] for i in expected]


def test_tells_progress(recorded, simulated):
    told = []
    sonarcal.compare(recorded, simulated, progress=lambda *step: told.append(step))
    assert told == [("Comparing", done, 4) for done in range(5)]


# What the figures are, worked out the slow way. No smoothing, no tidying: a pixel is object above the
# threshold.
PLAIN = {"segmentation": "fixed_threshold", "threshold": 0.25, "blur": (0, 0), "opening": (0, 0), "closing": (0, 0),
         "all_components": True}
EDGES_M = np.linspace(1.0, 5.0, 41)
BEAMS_DEG = np.linspace(-14.5, 14.5, 30)


def images(seed):
    random = np.random.default_rng(seed)
    real = random.integers(0, 256, (40, 30)).astype(np.uint8)
    simulated = np.clip(real + random.normal(0.0, 60.0, real.shape), 0, 255).astype(np.float64)
    return real, simulated


def reference(real, simulated, full_scale=255.0):
    r, s = real > 0.25 * full_scale, simulated.astype(np.float32) > 0.25 * full_scale
    both, either = r & s, r | s
    difference = (simulated.astype(np.float32) - real) / full_scale
    return {
        "ns": s.sum(), "nr": r.sum(), "na": both.sum(),
        "ns_over_nr": s.sum() / r.sum(), "na_over_ns": both.sum() / s.sum(), "na_over_nr": both.sum() / r.sum(),
        "iou": both.sum() / either.sum(), "dice": 2 * both.sum() / (r.sum() + s.sum()),
        "domains": {name: difference[where] for name, where in
                    (("union", either), ("overlap", both), ("whole", np.ones_like(r)))},
    }


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_figures_are_those_of_numpy(seed):
    real, simulated = images(seed)
    metrics = sonarcal.compare_images(real, simulated, range_edges_m=EDGES_M, beam_azimuth_deg=BEAMS_DEG, **PLAIN)
    expected = reference(real, simulated)
    (frame,) = metrics["frames"]
    for name in ("ns", "nr", "na"):
        assert frame[name] == expected[name]
    for name in ("ns_over_nr", "na_over_ns", "na_over_nr", "iou", "dice"):
        assert frame[name] == pytest.approx(expected[name], rel=1e-12)
    for name, difference in expected["domains"].items():
        found = frame["intensity"][name]
        assert found["mean_absolute"] == pytest.approx(np.abs(difference).mean(), rel=1e-5)
        assert found["rmse"] == pytest.approx(np.sqrt(np.square(difference).mean()), rel=1e-5)
        assert found["bias"] == pytest.approx(difference.mean(), rel=1e-5, abs=1e-7)
    assert frame["intensity_error"]["polar"] == frame["intensity"]["union"]["mean_absolute"]


def test_full_scale_and_valid_samples_count():
    real, simulated = images(5)
    valid = np.ones(real.shape, dtype=bool)
    valid[:, :7] = False
    metrics = sonarcal.compare_images(real * 16.0, simulated * 16.0, range_edges_m=EDGES_M,
                                      beam_azimuth_deg=BEAMS_DEG, full_scale=4095.0, valid=valid, **PLAIN)
    cut = reference(real[:, 7:] * 16.0, simulated[:, 7:] * 16.0, 4095.0)
    (frame,) = metrics["frames"]
    assert (frame["ns"], frame["nr"], frame["na"]) == (cut["ns"], cut["nr"], cut["na"])
    assert frame["intensity"]["whole"]["mean_absolute"] == pytest.approx(
        np.abs(cut["domains"]["whole"]).mean(), rel=1e-5)


def test_segment_is_what_compare_counts(recorded, simulated):
    real, sim = sonarcal.open_recording(recorded), sonarcal.open_recording(simulated)
    for options in ({}, PLAIN, {"segmentation": "otsu", "fill": "holes"}):
        metrics = sonarcal.compare(real, sim, sweep_steps=0, **options)
        for index, frame in enumerate(metrics["frames"]):
            r = sonarcal.segment(real[index].image, **options)
            s = sonarcal.segment(sim[index].image, **options)
            assert (frame["ns"], frame["nr"], frame["na"]) == (s.sum(), r.sum(), (r & s).sum())
    np.testing.assert_array_equal(sonarcal.segment(real[0].image, **PLAIN), real[0].image.value > 0.25 * 4095)


def test_a_model_of_ones_own_beside_a_recording(recorded):
    real = sonarcal.open_recording(recorded)
    own = sonarcal.recording([frame.image.value * 0.5 for frame in real], real.sonar, full_scale=real.full_scale,
                             source="half of it", synthetic=True)
    metrics = sonarcal.compare(real, own)
    assert metrics["simulated"] == "half of it (synthetic)"
    for frame, original in zip(metrics["frames"], real):
        assert frame["intensity"]["whole"]["bias"] == pytest.approx(-0.5 * original.image.value.mean() / 4095.0, rel=1e-5)
