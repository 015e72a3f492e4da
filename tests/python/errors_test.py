"""A mistake is an exception with the sentence of the command, which names options as keywords."""

import json
import re

import numpy as np
import pytest

import sonarcal
from conftest import PARAMETERS


def sentence(done):
    assert done.returncode in (1, 2), done
    text = done.stderr
    assert text.startswith("sonarcal: ") and text.count("\n") == 1
    return text[len("sonarcal: "):-1].split(" (see '")[0]


def with_keywords(text):
    """"--frozen-speckle" as "frozen_speckle"."""
    return re.sub(r"--([a-z]+(?:-[a-z]+)*)", lambda flag: flag.group(1).replace("-", "_"), text)


def expect(kind, done, call):
    with pytest.raises(kind) as raised:
        call()
    assert isinstance(raised.value, ValueError)
    assert str(raised.value) == (sentence(done) if kind is sonarcal.DataError else with_keywords(sentence(done)))
    assert done.returncode == (1 if kind is sonarcal.DataError else 2)


def simulate_words(world, *words, **files):
    return ["simulate", "--scene", files.get("scene", world.scene_file), "--sonar", files.get("sonar", world.sonar_file),
            "--params", files.get("params", world.params_file), "--poses", files.get("poses", world.poses_file), "--out",
            world.folder / "never", "--quiet", *words]


def test_data_errors_say_what_the_command_says(world, recorded, tmp_path):
    nowhere = tmp_path / "nowhere"
    expect(sonarcal.DataError, world.run("inspect", nowhere), lambda: sonarcal.open_recording(nowhere))
    broken = tmp_path / "broken.json"
    broken.write_text(json.dumps({**PARAMETERS, "displya": {}}, indent=1))
    expect(sonarcal.DataError, world.run(*simulate_words(world, params=broken)), lambda: sonarcal.read_parameters(broken))
    expect(sonarcal.DataError, world.run(*simulate_words(world, scene=nowhere)), lambda: sonarcal.read_scene(nowhere))
    expect(sonarcal.DataError, world.run(*simulate_words(world, poses=recorded / "frame_0000.png")),
           lambda: sonarcal.read_poses(recorded / "frame_0000.png"))
    short = tmp_path / "short"
    sonarcal.recording(np.zeros((2, 60, 24)), world.sonar).save(short)
    expect(sonarcal.DataError,
           world.run("compare", "--real", short, "--sim", recorded, "--out", world.folder / "never", "--quiet"),
           lambda: sonarcal.compare(short, recorded))


@pytest.mark.parametrize("words, options", [
    (["--bits", "9"], {"bits": 9}),
    (["--model", "papier"], {"model": "papier"}),
    (["--rays", "many"], {"rays": "many"}),
    (["--model", "acoustic", "--ray-weight", "solid_angle"], {"model": "acoustic", "ray_weight": "solid_angle"}),
    (["--frozen-speckle"], {"frozen_speckle": True}),
    (["--seed", "x"], {"seed": "x"}),
    (["--noise", "--seed", "-1"], {"noise": True, "seed": -1}),
    (["--seed", "5"], {"seed": 5}),
    (["--rays", "10x10"], {"rays": (10, 10)}),
])
def test_usage_errors_say_what_the_command_says(world, words, options):
    expect(sonarcal.UsageError, world.run(*simulate_words(world, *words)),
           lambda: sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses, **options))


def test_names_that_are_none(world):
    expect(sonarcal.UsageError, world.run(*simulate_words(world, sonar="p901")), lambda: sonarcal.sonar("p901"))
    expect(sonarcal.UsageError, world.run("scenes", "--only", "moon", "--out", world.folder / "never"),
           lambda: sonarcal.environment("moon"))


def test_arrays_that_do_not_fit_are_named(world):
    axes = sonarcal.PolarAxes(1.0, 2.0, 10, [-1.0, 0.0, 1.0])
    with pytest.raises(sonarcal.DataError, match=r"image 1: shape 3 x 10, expected 10 x 3 \(range bins x beams\)"):
        sonarcal.recording([np.zeros((10, 3)), np.zeros((3, 10))], axes)
    with pytest.raises(sonarcal.DataError, match="image 0: value 300 at range bin 2, beam 1, expected 0 .. 255"):
        value = np.zeros((10, 3))
        value[2, 1] = 300
        sonarcal.recording(value, axes)
    with pytest.raises(sonarcal.DataError, match="value nan at range bin 0, beam 0"):
        sonarcal.recording(np.full((10, 3), np.nan), axes)
    with pytest.raises(sonarcal.DataError, match="poses: 1 for 2 images, expected one for each"):
        sonarcal.recording(np.zeros((2, 10, 3)), axes, poses=[sonarcal.Pose()])
    with pytest.raises(ValueError):
        sonarcal.recording(np.zeros((10, 3)), axes, valid=[[1, 1, 1], [1]])
    with pytest.raises(sonarcal.DataError, match="range_edges_m: 2.5 m at index 1, expected 2 m"):
        sonarcal.PolarAxes.from_edges([1.0, 2.5, 3.0], [0.0, 1.0])
    with pytest.raises(sonarcal.DataError, match="axes"):
        sonarcal.PolarAxes(2.0, 1.0, 10, [0.0, 1.0])
    with pytest.raises(sonarcal.DataError, match="triangle_material: 2 at index 0, expected 0 .. 0"):
        sonarcal.Scene(np.eye(3), [[0, 1, 2]], [2], ["a"])
    with pytest.raises(sonarcal.DataError, match="quaternion_wxyz: length 2, expected 1"):
        sonarcal.Pose([0, 0, 0], [2, 0, 0, 0])
    with pytest.raises(sonarcal.DataError, match="frame 1 has no pose|pose"):
        sonarcal.recording(np.zeros((2, 10, 3)), axes).poses()


def test_parameters_name_the_key(world):
    wrong = json.loads(json.dumps(PARAMETERS))
    wrong["materials"]["box"]["gsab"]["D"] = "one"
    with pytest.raises(sonarcal.DataError, match="the parameters given:.*D"):
        sonarcal.resolve_parameters(wrong)
    with pytest.raises(sonarcal.DataError, match="the parameters given:.*surplus"):
        sonarcal.resolve_parameters({**PARAMETERS, "surplus": 1})
    with pytest.raises(TypeError):
        sonarcal.resolve_parameters({**PARAMETERS, "display": object()})


def test_unknown_keywords_are_refused_with_the_nearest_name(world):
    with pytest.raises(TypeError, match="'bites' is no option; did you mean 'bits'"):
        sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses, bites=8)
    with pytest.raises(TypeError, match="'bites' is no option"):
        sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses, {"bites": 8})


def test_frames_of_a_comparison_that_are_none_are_refused(recorded):
    with pytest.raises(sonarcal.DataError, match="frame 4 is to be compared"):
        sonarcal.compare(recorded, recorded, frames=[0, 4])
    with pytest.raises(sonarcal.DataError, match="frame -1 is to be compared"):
        sonarcal.compare(recorded, recorded, frames=[-1])
    with pytest.raises(sonarcal.UsageError, match="frames '0:2,1:3' name frame 1 twice"):
        sonarcal.compare(recorded, recorded, frames="0:2,1:3")
    with pytest.raises(sonarcal.UsageError, match="frames 'some', expected frames K and ranges A:B"):
        sonarcal.compare(recorded, recorded, frames="some")


def test_parameters_of_another_type_are_refused(world):
    with pytest.raises(TypeError, match="expected a dict, a path or Parameters, not int"):
        sonarcal.simulate(world.scene, world.sonar, 7, world.poses)
