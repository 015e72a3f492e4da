"""simulate() against the command for the same inputs, to the last bit."""

import json

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC, PARAMETERS, RAYS, SONAR


@pytest.mark.parametrize("model, noise", [("paper", False), ("paper", True), ("acoustic", False), ("acoustic", True),
                                          ("coherent", True)])
def test_equals_the_command(world, tmp_path, model, noise):
    params = world.params_file if model == "paper" else world.acoustic_file
    seed = 7 if noise else None
    words = ["--model", model, "--bits", "12"] + (["--noise", "--seed", "7"] if noise else [])
    by_command = world.simulate_command(f"{model}_{noise}", *words, params=params)
    recording = world.simulate(params, model=model, bits=12, seed=seed, noise=noise)
    recording.save(tmp_path / "saved")

    names = sorted(path.name for path in by_command.glob("frame_*.png"))
    assert len(names) == len(world.poses)
    shown = 0
    for index, name in enumerate(names):
        assert (tmp_path / "saved" / name).read_bytes() == (by_command / name).read_bytes()
        value = sonarcal.open_recording(by_command)[index].image.value
        np.testing.assert_array_equal(recording[index].image.value, value)
        shown += np.count_nonzero(value)
    assert shown > 1000  # else nothing is compared
    header = json.loads((tmp_path / "saved" / "recording.json").read_text())
    of_command = json.loads((by_command / "recording.json").read_text())
    header.pop("scene"), of_command.pop("scene")  # relative to the folder
    assert header == of_command


def test_options_as_the_command_has_them(world):
    by_command = world.simulate_command("frustum", "--sampling", "frustum", "--normals", "depth", rays="64x80")
    recording = sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses, sampling="frustum",
                                  normals="depth", rays="64x80")
    np.testing.assert_array_equal(recording[1].image.value, sonarcal.open_recording(by_command)[1].image.value)
    other = sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses, rays="64x80")
    assert np.any(other[1].image.value != recording[1].image.value)


def test_takes_poses_of_any_kind(world, recorded):
    from_file = world.simulate()
    options = {"scene": world.scene, "sonar": world.sonar_file, "params": PARAMETERS, "rays": RAYS}
    for poses in (world.poses, tuple(world.poses), sonarcal.open_recording(recorded), recorded):
        recording = sonarcal.simulate(poses=poses, **options)
        np.testing.assert_array_equal(recording[2].image.value, from_file[2].image.value)
    single = sonarcal.simulate(poses=world.poses[2], **options)
    assert len(single) == 1
    np.testing.assert_array_equal(single[0].image.value, from_file[2].image.value)


def test_times_of_a_recording_are_kept(world, tmp_path):
    timed = sonarcal.recording(np.zeros((4, 60, 24)), world.sonar, poses=world.poses, times_s=[0.0, 0.5, 1.5, 4.0])
    again = sonarcal.simulate(world.scene, timed, PARAMETERS, timed, rays=RAYS)
    assert again.times_s() == [0.0, 0.5, 1.5, 4.0]
    assert again.synthetic and again.details


def test_times_and_motion_of_a_file_and_of_a_recording_are_those_of_the_command(world, tmp_path):
    """A sonar that turns while four pings receive its beams."""
    pings = {"of_beam": [beam % 4 for beam in range(24)], "period_s": 0.01}
    sonar_file, poses_file = tmp_path / "sonar.json", tmp_path / "poses.json"
    sonar_file.write_text(json.dumps({**SONAR, "sonar": {**SONAR["sonar"], "pings": pings}}))
    poses = json.loads(world.poses_file.read_text())
    for index, pose in enumerate(poses["poses"]):
        pose.update(time_s=10.0 * index, motion={"turn_rate_deg_per_s": [0, 0, 66]})
    poses_file.write_text(json.dumps(poses))
    world.command("simulate", "--scene", world.scene_file, "--sonar", sonar_file, "--params", world.params_file, "--poses",
                  poses_file, "--rays", "96x200", "--quiet", "--out", tmp_path / "turning")
    by_command = sonarcal.open_recording(tmp_path / "turning")
    still = sonarcal.simulate(world.scene, sonar_file, PARAMETERS, world.poses, rays=RAYS)
    for source in (poses_file, str(poses_file), tmp_path / "turning", by_command):
        recording = sonarcal.simulate(world.scene, sonar_file, PARAMETERS, source, rays=RAYS)
        assert recording.times_s() == [0.0, 10.0, 20.0, 30.0]
        np.testing.assert_array_equal(recording[0].image.value, by_command[0].image.value)
        assert np.any(recording[0].image.value != still[0].image.value)


def test_tells_progress(world):
    told = []
    world.simulate(progress=lambda *step: told.append(step))
    assert told == [(step, done, 4) for step in ("Checking the poses", "Simulating") for done in (1, 2, 3, 4)]


def test_says_what_should_not_be_missed(world, caplog):
    mirrored = {**PARAMETERS, "mirror": {"floor": {"loss_db": 3}}}
    for _ in range(2):  # it is said once
        world.simulate(mirrored)
    done = world.run("simulate", "--scene", world.scene_file, "--sonar", world.sonar_file, "--params",
                     _written(world, mirrored), "--poses", world.poses_file, "--rays", "96x200", "--out",
                     world.folder / "mirrored")
    assert [r.message for r in caplog.records] == ["the paper's model shows no ghosts of the parameters' mirrors"]
    assert f"sonarcal: warning: {caplog.records[0].message}\n" == done.stderr


def _written(world, params):
    file = world.folder / "mirrored.json"
    sonarcal.write_parameters(params, file)
    return file


def test_acoustic_images_show_the_scene(world):
    value = world.simulate(ACOUSTIC)[0].image.value
    assert value.max() - np.median(value) > 40.0  # the echo of the box stands 12 dB and more over the rest
