"""Classes of options: values of every kind, limits, copies, repr, and the options' own descriptions."""

import copy
import inspect
import json

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC, PARAMETERS

CLASSES = [sonarcal.RayOptions, sonarcal.ComparisonOptions, sonarcal.SimulateOptions, sonarcal.CompareOptions,
           sonarcal.FitOptions, sonarcal.ExplainOptions, sonarcal.LocateOptions, sonarcal.CalibrateOptions,
           sonarcal.JudgeNoiseOptions, sonarcal.TransferOptions]


@pytest.mark.parametrize("cls", CLASSES)
def test_every_option_has_attribute_docstring_and_default(cls):
    options = cls()
    for option in cls.describe():
        name = option["name"]
        assert getattr(options, name) == option["default"], name
        text = getattr(cls, name).__doc__
        assert text == option["text"] and option["help"] in text and option["type"] in text, name
        assert option["unit"] in option["type"], name
    assert repr(options) == cls.__name__ + "()"
    names = [p.name for p in inspect.signature(cls).parameters.values()]
    assert names == ["source", *(option["name"] for option in cls.describe())]


@pytest.mark.parametrize("cls", CLASSES)
def test_a_dict_of_all_options_makes_them_again(cls):
    some = {"rays": (40, 30), "cell": (3, 1), "region_range": (1, 2), "range_min": 1.5, "object": "box"}
    changed = cls(**{name: value for name, value in some.items() if hasattr(cls, name)})
    assert changed != cls() and cls(changed.to_dict()) == changed and cls(changed) == changed
    assert changed.to_dict().keys() == {option["name"] for option in cls.describe()}


def test_keywords_win_over_the_source():
    options = sonarcal.FitOptions({"starts": 2, "free": ["materials"]}, starts=7)
    assert (options.starts, options.free) == (7, ["materials"])
    other = sonarcal.FitOptions(options, free=None)
    assert other.free is None and options.free == ["materials"]


def test_repr_shows_what_differs_from_the_default():
    options = sonarcal.FitOptions(free=["materials"], starts=2, rays=(40, 30), region_range=(1, 2.5), looks=1.0)
    assert repr(options) == "FitOptions(free=['materials'], rays=(40, 30), starts=2, region_range=(1.0, 2.5))"
    assert eval(repr(options), vars(sonarcal)) == options  # pylint: disable=eval-used


SAME = [
    ("cell", (3, 2), ["3x2", [3, 2], np.array([3, 2])]),
    ("blur", (0.5, 2.0), ["0.5x2", (np.float32(0.5), 2)]),
    ("rays", (40, 30), ["40x30", np.array([40, 30])]),
    ("region_range", (0.5, 3.0), ["0.5:3", [0.5, np.float64(3)]]),
    ("region_polygon", [(1.5, -4.0), (1.5, 4.0), (2.0, 0.0)],
     ["1.5:-4,1.5:4,2:0", np.array([[1.5, -4], [1.5, 4], [2, 0]])]),
    ("held_out", [1, 3], ["1,3", "1:2,3:4", (1, 3), np.array([1, 3]), range(1, 4, 2)]),
    ("held_out", "3,80:", ["3,80:"]),
    ("free", ["materials", "display.*"], ["materials,display.*", ("materials", "display.*")]),
    ("choose", ["looks", "display"], ["looks,display"]),
    ("segmentation", "otsu", ["otsu"]),
    ("sigma_count", 3.0, [3, np.float32(3.0), np.int64(3)]),
    ("starts", 2, [np.int64(2), np.uint8(2)]),
    ("trust_all", True, [np.bool_(True)]),
    ("contrast_db", None, [None]),
    ("object", None, [None]),
]


@pytest.mark.parametrize("name, value, others", SAME, ids=[name for name, _, _ in SAME])
def test_values_of_every_kind(name, value, others):
    expected = sonarcal.FitOptions({name: value})
    assert getattr(expected, name) == value
    for other in others:
        options = sonarcal.FitOptions()
        setattr(options, name, other)
        assert options == expected, other
    setattr(expected, name, None)
    assert expected == sonarcal.FitOptions()


WRONG = [
    ("starts", 0, "starts 0, expected 1 to 100"),
    ("starts", "many", "starts 'many', expected a whole number"),
    ("starts", 2.5, "starts '2.5', expected a whole number"),
    ("starts", True, "starts 'True', expected a whole number"),
    ("starts", 2**40, "starts '1099511627776', expected a whole number"),
    ("threads", -1, "threads -1, expected 0 to 1024"),
    ("looks", "2", "looks '2', expected a number"),
    ("looks", float("nan"), "looks 'nan', expected a number"),
    ("trust_all", 1, "trust_all '1', expected True or False"),
    ("segmentation", "otsi", r"segmentation 'otsi', did you mean 'otsu'"),
    ("segmentation", 3, r"segmentation '3', expected .*otsu"),
    ("cell", (1, 2, 3), r"cell '\(1, 2, 3\)', expected \(range bins, beams\)"),
    ("cell", (1.5, 2), r"cell '\(1.5, 2\)', expected \(range bins, beams\)"),
    ("cell", "3", "cell '3', expected rows x columns, such as 7x3"),
    ("rays", (0, 5), r"rays '\(0, 5\)', expected \(columns, rows\), both above 0"),
    ("region_range", (3, 1), r"region_range '\(3, 1\)', expected \(low, high\), low below high"),
    ("held_out", 3, "held_out '3', expected list of int, or text"),
    ("free", {"materials": 1}, "free '{'materials': 1}', expected list of str"),
    ("config", 3, "config '3', expected dict or path"),
    ("region", [1, 2, 3], r"region '\[1, 2, 3\]', expected array \(range bins, beams\) or path"),
]


@pytest.mark.parametrize("name, value, sentence", WRONG)
def test_wrong_values_are_named_in_one_sentence(name, value, sentence):
    with pytest.raises(sonarcal.UsageError, match="^" + sentence + ".*$"):
        sonarcal.FitOptions({name: value})
    options = sonarcal.FitOptions()
    with pytest.raises(sonarcal.UsageError, match="^" + sentence):
        setattr(options, name, value)
    assert options == sonarcal.FitOptions()


def test_names_that_are_none_are_refused():
    with pytest.raises(TypeError, match="FitOptions: 'start' is no option; did you mean 'starts'"):
        sonarcal.FitOptions(start=1)
    with pytest.raises(TypeError, match="FitOptions: expected FitOptions, a dict or None, not SimulateOptions"):
        sonarcal.FitOptions(sonarcal.SimulateOptions())
    with pytest.raises(AttributeError):
        sonarcal.FitOptions().start = 1


def test_parameters_from_dict_object_and_file(world):
    by_dict = sonarcal.CompareOptions(params=PARAMETERS)
    by_object = sonarcal.CompareOptions(params=sonarcal.Parameters(PARAMETERS))
    by_file = sonarcal.CompareOptions(params=world.params_file)
    assert by_dict == by_object == by_file
    assert by_file.params == sonarcal.Parameters(PARAMETERS)
    assert repr(by_file) == f"CompareOptions(params='{world.params_file}')"
    assert repr(by_dict) == "CompareOptions(params=...)"
    assert by_dict != sonarcal.CompareOptions(params=ACOUSTIC)
    with pytest.raises(sonarcal.DataError, match="the parameters given"):
        sonarcal.CompareOptions(params={"format": "sonar-parameters/1"})
    with pytest.raises(sonarcal.DataError, match="nowhere.json"):
        sonarcal.CompareOptions(params="nowhere.json")


def test_a_fit_configuration_from_dict_and_file(tmp_path):
    config = {"format": "sonar-fit-config/1", "free": ["materials"], "fixed": ["material.box.*"],
              "bounds": {"receiver.noise_db": [80, 120]}, "priors": {"beam.azimuth_width_deg": [1.0, 0.05],
                                                                     "receiver.noise_db": "none"},
              "pose_prior": {"position_m": 0.02}, "held_out": [np.int64(2)]}
    by_dict = sonarcal.FitOptions(config=config)
    (tmp_path / "config.json").write_text(json.dumps(config, default=int))
    assert by_dict == sonarcal.FitOptions(config=tmp_path / "config.json")
    assert sonarcal.FitOptions(config=by_dict.config) == by_dict
    assert by_dict.config["held_out"] == [2] and by_dict.config["pose_prior"] == {"position_m": 0.02, "angle_deg": 3.0}
    with pytest.raises(sonarcal.DataError, match="config:.*fre"):
        sonarcal.FitOptions(config={"format": "sonar-fit-config/1", "fre": []})


def test_a_region_from_array_and_png(world, recorded):
    region = np.zeros((60, 24), dtype=bool)
    region[20:40, 5:20] = True
    options = sonarcal.ComparisonOptions(region=region)
    np.testing.assert_array_equal(options.region, region)
    assert options == sonarcal.ComparisonOptions(region=region.astype(float) * 9)
    image = sonarcal.open_recording(recorded)[0].image
    png = recorded / "frame_0000.png"
    np.testing.assert_array_equal(sonarcal.ComparisonOptions(region=png).region, image.value > 0)
    plain = {"segmentation": "fixed_threshold", "threshold": 0.01, "blur": (0, 0), "opening": (0, 0), "closing": (0, 0),
             "all_components": True}
    whole = sonarcal.segment(image, plain)
    np.testing.assert_array_equal(sonarcal.segment(image, plain, region=region), whole & region)
    with pytest.raises(sonarcal.DataError, match="region: 3 x 3 pixels, expected 60 range bins x 24 beams"):
        sonarcal.segment(image, region=np.ones((3, 3)))


def test_descriptions_cannot_change_the_options():
    described = copy.deepcopy(sonarcal.FitOptions.describe())
    sonarcal.FitOptions.describe()[0]["name"] = "other"
    assert sonarcal.FitOptions.describe() == described
