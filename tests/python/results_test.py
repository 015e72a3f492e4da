"""Results: attributes, tables and pictures."""

import copy
import json
import pickle

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC, PARAMETERS

FIT = {"free": ["materials"], "held_out": [3], "starts": 1, "max_iterations": 10, "rays": (48, 100)}


@pytest.fixture(scope="module")
def pyplot():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    yield plt
    plt.close("all")


@pytest.fixture(scope="module")
def comparison(recorded, simulated):
    return sonarcal.compare(recorded, simulated)


@pytest.fixture(scope="module")
def fitted(world, recorded):
    return sonarcal.fit(recorded, world.scene, PARAMETERS, FIT)


@pytest.fixture(scope="module")
def acoustic_recording(world):
    return world.simulate_command("acoustic_recording", "--noise", "--bits", "12", params=world.acoustic_file)


@pytest.fixture(scope="module")
def explanation(world, acoustic_recording):
    return sonarcal.explain(acoustic_recording, world.scene, ACOUSTIC, max_iterations=10, rays=(48, 100))


def test_a_comparison_is_the_dict_of_its_metrics(comparison):
    assert isinstance(comparison, dict) and comparison.macro is comparison["macro"]
    assert comparison.micro is comparison["micro"] and comparison.frames is comparison["frames"]
    assert json.loads(json.dumps(comparison)) == comparison
    for copied in (copy.deepcopy(comparison), pickle.loads(pickle.dumps(comparison))):
        assert isinstance(copied, sonarcal.Comparison) and copied == comparison
        with pytest.raises(ValueError, match="no images"):
            copied.plot()


def test_a_pair_of_a_comparison_holds_its_images_and_objects(comparison, recorded, simulated):
    pair = comparison.pair(2)
    assert pair.index == 2
    np.testing.assert_array_equal(pair.real, sonarcal.open_recording(recorded)[2].image)
    np.testing.assert_array_equal(pair.simulated, sonarcal.open_recording(simulated)[2].image)
    np.testing.assert_array_equal(pair.real_object, sonarcal.segment(pair.real))
    assert pair.simulated_object.sum() == comparison.frames[2]["ns"]


def test_a_fit_result_has_its_figures_as_attributes(fitted):
    assert fitted.metrics_before == fitted.report["metrics_before"]
    assert fitted.metrics_after.macro == fitted.report["metrics_after"]["macro"]
    assert fitted.warnings == fitted.report["warnings"]
    assert {p["name"] for p in fitted.free} == {p["name"] for p in fitted.report["parameters"]
                                                if p["name"].startswith("material.")}
    assert [pair.index for pair in fitted.frames_after] == [3] == [pair.index for pair in fitted.frames_before]
    assert repr(fitted) == f"FitResult({len(fitted.free)} parameters fitted, frames [0, 1, 2])"
    again = pickle.loads(pickle.dumps(fitted))
    assert again == fitted and again.frames_after == []
    with pytest.raises(ValueError, match="no images"):
        again.plot()


def test_explain_equals_the_command(world, acoustic_recording, explanation, tmp_path):
    world.command("explain", "--real", acoustic_recording, "--scene", world.scene_file, "--params", world.acoustic_file,
                  "--max-iterations", "10", "--rays", "48x100", "--quiet", "--out", tmp_path / "out")
    assert explanation.report == json.loads((tmp_path / "out" / "explain.json").read_text())
    assert explanation.parameters == sonarcal.read_parameters(tmp_path / "out" / "params.json")


def test_an_explanation_has_its_steps_by_name(explanation):
    assert explanation.steps[0]["part"] == "start" and explanation["noise"]["verdict"]
    with pytest.raises(KeyError):
        explanation["weather"]
    assert [each.index for each in explanation.maps] == explanation.report["frames_held_out"]
    cause = explanation.maps[0].cause
    assert cause.shape == (60, 24) == explanation.maps[0].lobe_of.shape and cause.dtype == np.uint8
    assert cause.max() < len(explanation.cause_names)
    assert np.count_nonzero(cause) == explanation.report["causes"]["frames"][0]["bright_cells"]
    assert explanation.maps[0].recorded.value.shape == (60, 24)
    assert repr(explanation).startswith("Explanation(start, response")


def test_explain_says_what_it_fits(world, acoustic_recording, caplog):
    steps = []
    with caplog.at_level("INFO", logger="sonarcal"):
        sonarcal.explain(acoustic_recording, world.scene, ACOUSTIC, max_iterations=3, rays=(48, 100),
                         progress=lambda what, done, total: steps.append(what))
    assert "fitting: start" in [record.message for record in caplog.records]
    assert set(steps) == {"Fitting"}
    with pytest.raises(sonarcal.DataError, match="only 'acoustic' can be explained"):
        sonarcal.explain(acoustic_recording, world.scene, PARAMETERS)


def test_tables_for_notebooks(comparison, fitted, explanation):
    html = comparison._repr_html_()
    assert "<table>" in html and "IoU" in html and f"{comparison.macro['iou']:.4g}" in html
    html = fitted._repr_html_()
    assert html.count("<table>") == 2 and "material.floor.gsab.C" in html
    html = explanation._repr_html_()
    assert "response" in html and "of the bright cells" in html


def drawn(figure):
    figure.canvas.draw()
    return [panel.get_title() for panel in figure.axes if panel.get_title()]


def test_pictures(pyplot, comparison, fitted, explanation):
    assert drawn(comparison.plot(2))[:2] == ["frame 2: real", "frame 2: simulated"]
    assert len(drawn(comparison.plot())) == 3
    assert drawn(fitted.plot())[:2] == ["frame 3: recorded", "frame 3: fitted"]
    with pytest.raises(ValueError, match=r"frame 0 is not kept, expected one of \[3\]"):
        fitted.plot(0)
    assert drawn(explanation.plot())[0] == "held-out frames"
    with pytest.raises(ValueError, match="is not held out"):
        explanation.plot(99)


def test_matplotlib_is_imported_only_for_pictures():
    import subprocess
    import sys

    code = "import sys, sonarcal; print('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"
