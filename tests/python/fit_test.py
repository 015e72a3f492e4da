"""fit() against the command, and residual_view() against what a fit says and against differences."""

import json

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC, PARAMETERS

START = {**PARAMETERS, "materials": {
    "floor": {"gsab": {"A": 50, "B_deg": 6, "C": 1, "D": 1, "E": 5, "F_deg": 10}},
    "box": {"gsab": {"A": 50, "B_deg": 6, "C": 1, "D": 1, "E": 5, "F_deg": 10}},
}}
FREE = ["material.floor.gsab.C", "material.box.gsab.C", "display.db_max"]
OPTIONS = {"free": FREE, "held_out": [3], "starts": 1, "max_iterations": 20, "rays": "48x100", "threads": 1}


def start_file(world):
    file = world.folder / "start.json"
    sonarcal.write_parameters(START, file)
    return file


@pytest.fixture(scope="module")
def result(world, recorded):
    return sonarcal.fit(recorded, world.scene_file, START, **OPTIONS)


def test_equals_the_command(world, recorded, result, tmp_path):
    world.command("fit", "--real", recorded, "--scene", world.scene_file, "--params", start_file(world), "--free",
                  ",".join(FREE), "--held-out", "3", "--starts", "1", "--max-iterations", "20", "--rays", "48x100",
                  "--threads", "1", "--quiet", "--out", tmp_path / "fit")
    by_command = json.loads((tmp_path / "fit" / "fit.json").read_text())
    report = dict(result.report)
    assert report.pop("timing_s").keys() == by_command.pop("timing_s").keys()
    assert report == by_command
    assert result.usable and result.poses == []
    assert result.parameters == json.loads((tmp_path / "fit" / "params.json").read_text())


def test_a_material_may_have_a_prior_and_no_curve_as_for_the_command(world, tmp_path):
    real = world.simulate_command("acoustic_real", "--noise", "--bits", "12", params=world.acoustic_file)
    materials = {**ACOUSTIC["materials"], "floor": {"prior": "sand:medium"}}
    given = {**ACOUSTIC, "materials": materials}
    start = tmp_path / "start.json"
    start.write_text(json.dumps(given))
    free = "material.floor.gsab.C"
    world.command("fit", "--real", real, "--scene", world.scene_file, "--params", start, "--free", free, "--held-out", "3",
                  "--starts", "1", "--max-iterations", "20", "--rays", "48x100", "--threads", "1", "--quiet", "--out",
                  tmp_path / "fit")
    for params in (start, given):
        result = sonarcal.fit(real, world.scene_file, params, **{**OPTIONS, "free": [free]})
        assert result.parameters == json.loads((tmp_path / "fit" / "params.json").read_text())
        assert result.parameters["materials"]["floor"]["prior"] == "sand:medium"


def test_takes_a_configuration_as_a_dict(world, recorded, result):
    config = {"format": "sonar-fit-config/1", "free": FREE, "held_out": [3]}
    again = sonarcal.fit(recorded, world.scene, START, config=config,
                         **{k: v for k, v in OPTIONS.items() if k not in ("free", "held_out")})
    assert again.parameters == result.parameters


def test_takes_options_as_an_object_or_a_dict(world, recorded, result):
    for options in (OPTIONS, sonarcal.FitOptions(**OPTIONS)):
        assert sonarcal.fit(recorded, world.scene, START, options).parameters == result.parameters
    again = sonarcal.fit(recorded, world.scene, sonarcal.Parameters(START), {**OPTIONS, "starts": 3}, starts=1)
    assert again.parameters == result.parameters


def test_a_parameter_by_its_name(result):
    entry = result["material.floor.gsab.C"]
    assert entry["status"] == "free" and entry["initial"] == 1.0 and entry["sigma"] > 0.0
    assert result.parameters["materials"]["floor"]["gsab"]["C"] == entry["value"]
    with pytest.raises(KeyError):
        result["material.floor.gsab.Z"]


def test_the_view_has_the_cost_of_the_fit(world, recorded, result):
    view = sonarcal.residual_view(recorded, world.scene, START, frames=[0, 1, 2], rays="48x100")
    assert view.frames == [0, 1, 2]

    def cost(values):
        return sum(0.5 * np.square(view.at(values, frame).residual).sum() for frame in view.frames)

    fitted = view.initial.copy()
    for i, name in enumerate(view.names):
        fitted[i] = result[name]["value"]
        assert view.initial[i] == result[name]["initial"]
        assert view.units[i] == result[name]["unit"]
    at = view.at(fitted, 1)
    # A fit interpolates curves between incidence nodes, an expected image hardly.
    np.testing.assert_allclose(at.residual, (at.expected.value - at.recorded.value) / 4095.0, atol=1e-4)
    assert at.counted.all() and at.jacobian.shape == (60, 24, 0)
    view.weigh_about(fitted)
    assert cost(view.initial) == pytest.approx(result.report["cost_initial"], rel=1e-9)
    assert cost(fitted) == pytest.approx(result.report["cost_final"], rel=1e-9)


@pytest.mark.parametrize("model", ["paper", "acoustic"])
def test_the_jacobian_is_that_of_differences(world, recorded, model):
    params = ACOUSTIC if model == "acoustic" else PARAMETERS
    real = world.simulate(ACOUSTIC, noise=True, bits=12) if model == "acoustic" else recorded
    names = ["material.floor.gsab.C", "material.box.gsab.D",
             "receiver.noise_db" if model == "acoustic" else "jitter.sigma_range_m"]
    view = sonarcal.residual_view(real, world.scene, params, frames=[0], rays="48x100")
    # Off the truth, where residuals of the acoustic model are smooth.
    values = view.initial.copy()
    at = view.at(values, 0, names)
    assert at.names == names and at.jacobian.shape == (60, 24, 3)
    for k, name in enumerate(names):
        i = view.names.index(name)
        step = 1e-4 * max(1.0, abs(values[i]))
        above, below = values.copy(), values.copy()
        above[i] += step
        below[i] -= step
        slope = (view.at(above, 0).residual - view.at(below, 0).residual) / (2 * step)
        scale = np.abs(slope).max()
        assert scale > 0.0
        # A difference is no derivative across the clamp of the display, in a few pixels.
        off = np.abs(at.jacobian[:, :, k] - slope) > 1e-3 * scale
        assert np.mean(off) < 0.01, name


def test_the_view_names_what_is_wrong(world, recorded):
    view = sonarcal.residual_view(recorded, world.scene, PARAMETERS, frames=[1], rays="48x100")
    with pytest.raises(sonarcal.DataError, match="'nonsense' is no parameter of this model"):
        view.at(view.initial, 1, ["nonsense"])
    with pytest.raises(sonarcal.DataError, match="frame 0 is not among those of this view"):
        view.at(view.initial, 0)
    with pytest.raises(sonarcal.DataError, match="expected one for each"):
        view.at(view.initial[:-1], 1)
    with pytest.raises(sonarcal.DataError, match="frame 9 is asked for, but the recording has 4"):
        sonarcal.residual_view(recorded, world.scene, PARAMETERS, frames=[9])
