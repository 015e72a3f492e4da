"""calibrate() and judge_noise() against the commands."""

import json

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC

PLAN = {
    "format": "sonar-calibration-plan/1",
    "decided": [{"stage": "frames"}, {"stage": "placement", "choice": "as declared"}, {"stage": "beam"},
                {"stage": "mirrors", "choice": "none"}],
    "fit": {"format": "sonar-fit-config/1", "used": [0, 1], "held_out": [2]},
}
RAYS = "48x100"


@pytest.fixture(scope="module")
def real(world):
    return world.simulate_command("calibrated_real", "--noise", "--bits", "12", params=world.acoustic_file)


@pytest.fixture(scope="module")
def calibration(world, real):
    return sonarcal.calibrate(real, world.scene_file, plan=PLAN, rays=RAYS, threads=1)


def test_calibrate_equals_the_command(world, real, calibration, tmp_path):
    (tmp_path / "plan.json").write_text(json.dumps(PLAN))
    out = tmp_path / "out"
    world.command("calibrate", "--real", real, "--scene", world.scene_file, "--plan", tmp_path / "plan.json", "--rays",
                  RAYS, "--threads", "1", "--quiet", "--out", out)
    assert calibration.parameters == json.loads((out / "params.json").read_text())
    assert calibration.plan == json.loads((out / "plan.json").read_text())
    by_command = json.loads((out / "fit.json").read_text())
    report = dict(calibration.report)
    assert report.pop("timing_s").keys() == by_command.pop("timing_s").keys()
    assert report == by_command
    for mine, theirs in zip(calibration.poses, sonarcal.read_poses(out / "poses.json"), strict=True):
        np.testing.assert_allclose(mine.matrix, theirs.matrix, atol=1e-12)


def test_a_calibration_holds_decisions_and_both_fits(real, calibration, tmp_path):
    assert {each["stage"] for each in calibration.decisions} == {
        "frames", "water", "noise", "placement", "beam", "mirrors"}
    assert calibration.fit.usable and calibration.evaluation.usable
    assert calibration.evaluation.report["frames_held_out"] == [2]
    assert calibration.report["frames_used"] == [0, 1, 2]
    assert calibration.metrics_after.macro["iou"] is not None
    assert calibration["receiver.noise_db"]["status"] == "free"
    assert calibration.scene is None and len(calibration.poses) == 4
    assert all(isinstance(sentence, str) for sentence in calibration.open + calibration.warnings)
    assert "placement: as declared" in repr(calibration)
    assert "as declared" in calibration._repr_html_()
    calibration.sonar.save(tmp_path / "sonar.json")
    saved = sonarcal.sonar(str(tmp_path / "sonar.json"))
    np.testing.assert_allclose(saved.axes.range_edges_m, calibration.sonar.axes.range_edges_m)
    corrected = sonarcal.open_recording(real).with_sonar(calibration.sonar)
    assert corrected.sonar.axes.range_bins == 60


def test_a_wrong_plan_is_named_in_one_sentence(world, real):
    with pytest.raises(sonarcal.DataError, match="plan.*weather.*expected one of frames, water"):
        sonarcal.calibrate(real, world.scene, plan={**PLAN, "decided": [{"stage": "weather"}]})
    with pytest.raises(TypeError, match="plan: expected a dict, a path or None"):
        sonarcal.calibrate(real, world.scene, plan=3)


@pytest.fixture(scope="module")
def noise(world):
    """Pings of nothing but noise, and the law that the command fits to them."""
    pose = sonarcal.Pose([50.0, 50.0, 50.0])
    pings = sonarcal.simulate(world.scene, world.sonar, ACOUSTIC, [pose] * 12, noise=True, bits=8, rays=(48, 100))
    pings.save(world.folder / "pings")
    world.command("fit", "--noise-only", "--real", world.folder / "pings", "--held-out", "8:", "--quiet", "--out",
                  world.folder / "noise")
    return pings, world.folder / "noise" / "params.json"


def test_judge_noise_equals_the_command(world, noise, tmp_path):
    pings, law = noise
    world.command("judge-noise", "--params", law, "--real", world.folder / "pings", "--frames", "6:", "--quiet", "--out",
                  tmp_path / "judged")
    judged = sonarcal.judge_noise(pings, law, frames="6:")
    assert judged == json.loads((tmp_path / "judged" / "judgement.json").read_text())
    assert judged == sonarcal.judge_noise(pings, law, frames=range(6, 12))
    assert len(judged.pings) == 6 and judged.agreement["ks"] < 0.2 and judged.cells
    assert "pings beyond chance" in judged._repr_html_() and "6 pings" in repr(judged)


def test_judge_noise_measures_false_alarms_as_the_command(world, noise):
    pings, law = noise
    text = world.command("judge-noise", "--params", law, "--real", world.folder / "pings", "--false-alarms", "--json",
                         "--quiet")
    judged = sonarcal.judge_noise(pings, law, false_alarms=True)
    assert judged == json.loads(text)
    assert {row["method"] for row in judged.false_alarms} >= {"otsu", "ca_cfar", "likelihood_ratio"}
    assert sonarcal.judge_noise(pings, law).false_alarms == []


def test_judge_noise_takes_window_and_speckle(noise):
    pings, law = noise
    near = sonarcal.judge_noise(pings, law, range_max=2.5)
    assert max(cell["range_m"][1] for cell in near.cells) <= 2.5
    speckle = json.loads((law.parent / "fit.json").read_text())["speckle"]
    assert near == sonarcal.judge_noise(pings, sonarcal.read_parameters(law), range_max=2.5, speckle=speckle)
    with pytest.raises(sonarcal.UsageError, match="speckle 'grainy', expected gamma|weighted|k"):
        sonarcal.judge_noise(pings, law, speckle="grainy")
    with pytest.raises(sonarcal.DataError, match="frame 12 is to be judged, but there are frames 0 to 11"):
        sonarcal.judge_noise(pings, law, frames=[12])
