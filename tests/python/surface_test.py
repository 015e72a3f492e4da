"""Stubs and module agree, Python has all options of the commands, and everything public is documented."""

import ast
import inspect
import pathlib
import pydoc
import re
import types

import pytest

import sonarcal
from sonarcal import _sonarcal

STUB = pathlib.Path(sonarcal.__file__).with_name("_sonarcal.pyi")
# Of every class of pybind11, or of none.
COMMON = {"__module__", "__doc__", "__weakref__", "__dict__", "__new__", "__hash__", "__init__", "__signature__"}


def stub_surface():
    """{name: {member: parameter names or None}} and {function: parameter names}."""
    classes, functions, values = {}, {}, set()

    def parameters(node):
        """Names; options of a constructor, which are keywords only, are left out."""
        only = [] if node.name == "__init__" else node.args.kwonlyargs
        return [argument.arg for argument in node.args.args + only if argument.arg != "self"]

    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = parameters(node)
        elif isinstance(node, ast.AnnAssign):
            values.add(node.target.id)
        elif isinstance(node, ast.ClassDef):
            members = {}
            for member in node.body:
                if isinstance(member, ast.FunctionDef):
                    if any(getattr(d, "attr", "") == "setter" for d in member.decorator_list):
                        continue
                    is_property = any(getattr(d, "id", "") == "property" for d in member.decorator_list)
                    members[member.name] = None if is_property else parameters(member)
            classes[node.name] = members
    return classes, functions, values


def signature(function):
    """Names of the parameters, from the first line of pybind11's docstring."""
    line = function.__doc__.splitlines()[0]
    inside = re.match(r"\w+\((.*)\) -> ", line).group(1)
    names = re.findall(r"(?:^|, )(\w+)(?=: )", re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", inside)))
    return [name for name in names if name != "self"]


CLASSES, FUNCTIONS, VALUES = stub_surface()


def test_stub_and_module_name_the_same():
    module = {name for name in vars(_sonarcal) if not name.startswith("__") or name == "__version__"}
    assert module == set(CLASSES) | set(FUNCTIONS) | VALUES


@pytest.mark.parametrize("name", [name for name, members in CLASSES.items() if members])
def test_classes_have_what_the_stub_says(name):
    members = CLASSES[name]
    real = {k: v for k, v in vars(getattr(_sonarcal, name)).items() if k not in COMMON and not k.startswith("_pybind")}
    declared = {k: v for k, v in members.items() if k != "__init__"}
    assert set(real) == set(declared)
    for member, parameters in declared.items():
        is_property = isinstance(inspect.getattr_static(getattr(_sonarcal, name), member), property)
        assert is_property == (parameters is None), member
        if parameters is not None and not member.startswith("__"):
            assert signature(getattr(getattr(_sonarcal, name), member)) == parameters, member
    if "__init__" in members:
        assert signature(getattr(_sonarcal, name).__init__) == members["__init__"]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_take_what_the_stub_says(name):
    assert signature(getattr(_sonarcal, name)) == FUNCTIONS[name]


FUNCTIONS_OF = {
    "simulate": (sonarcal.simulate, sonarcal.SimulateOptions, {"progress"}),
    "compare": (sonarcal.compare, sonarcal.CompareOptions, {"frames", "scene", "scene_unit", "scene_up", "progress"}),
    "fit": (sonarcal.fit, sonarcal.FitOptions, {"progress"}),
    "calibrate": (sonarcal.calibrate, sonarcal.CalibrateOptions, {"background", "plan", "progress"}),
    "judge-noise": (sonarcal.judge_noise, sonarcal.JudgeNoiseOptions, {"frames", "progress"}),
    "locate": (sonarcal.locate, sonarcal.LocateOptions, {"frame", "poses", "progress"}),
    "explain": (sonarcal.explain, sonarcal.ExplainOptions, {"progress"}),
    "transfer": (sonarcal.transfer, sonarcal.TransferOptions, {"train_masks", "progress"}),
}

# Options of the commands that are other things in Python: positional arguments, files, terminal output,
# recordings that the project knows, and fits without a scene.
ELSEWHERE = {
    "simulate": {"scene", "scene-unit", "scene-up", "sonar", "params", "poses", "out", "force", "fan", "depth",
                 "resume", "frames"},
    "compare": {"real", "sim", "sonar", "out", "force", "sweep-csv", "pictures", "fail-above", "part", "merge"},
    "fit": {"real", "sonar", "scene", "scene-unit", "scene-up", "params", "poses", "out", "force", "noise-only", "still",
            "range-min", "range-max", "find-background", "hold-out-bands", "reject-beyond", "standard-target", "diameter-mm",
            "bandwidth-khz", "temperature-sigma", "second-target"},
    "calibrate": {"real", "poses", "scene", "scene-unit", "scene-up", "out", "force", "resume"},
    "judge-noise": {"params", "real", "out", "force"},
    "locate": {"real", "target", "scene-unit", "scene-up", "out", "force"},
    "explain": {"real", "sonar", "scene", "scene-unit", "scene-up", "params", "out", "force", "known", "recordings", "apart"},
    "transfer": {"train", "test", "test-masks", "out", "force"},
}
TERMINAL = {"help", "json", "quiet", "verbose", "log", "options"}


def keywords(function):
    return [p for p in inspect.signature(function).parameters.values() if p.kind is p.KEYWORD_ONLY]


@pytest.mark.parametrize("command", ELSEWHERE)
def test_python_has_every_option_of_a_command(world, command):
    options = set(re.findall(r"^  (?:-\w, )?--([a-z-]+)", world.command(command, "--help"), re.MULTILINE)) - TERMINAL
    names = {p.name.replace("_", "-") for p in keywords(FUNCTIONS_OF[command][0])} - {"progress"}
    assert names == options - ELSEWHERE[command]


@pytest.mark.parametrize("command", FUNCTIONS_OF)
def test_the_signature_has_every_option_of_the_description_with_its_default(command):
    function, options_class, own = FUNCTIONS_OF[command]
    defaults = {p.name: p.default for p in keywords(function) if p.name not in own}
    assert defaults == {option["name"]: option["default"] for option in options_class.describe()}
    assert inspect.signature(function).parameters["options"].default is None


@pytest.mark.parametrize("command", FUNCTIONS_OF)
def test_help_explains_every_option_with_unit_and_default(command):
    function, options_class, _ = FUNCTIONS_OF[command]
    text = " ".join(pydoc.render_doc(function, renderer=pydoc.plaintext).split())
    for option in options_class.describe():
        assert f" {option['name']} : optional {' '.join(option['text'].split())}" in text, option["name"]
        assert "; default: " in option["text"], option["name"]
        assert not option["unit"] or f" in {option['unit']}; " in option["text"], option["name"]


def test_help_shows_units_limits_words_and_defaults():
    text = {option["name"]: option["text"] for option in sonarcal.FitOptions.describe()}
    assert text["region_range"].endswith("(low, high) in m; default: None.")
    assert text["starts"].endswith("int; 1 to 100; default: 4.")
    assert "'even', 'solid_angle'; default: even; " in text["ray_weight"]
    assert "list of int, or text such as '3,80:'; default: the last third" in text["held_out"]


def test_all_names_what_is_public():
    public = {name for name, value in vars(sonarcal).items()
              if not name.startswith("_") and not isinstance(value, types.ModuleType)
              and str(getattr(value, "__module__", "")).split(".")[0] == "sonarcal"}
    assert public | {"__version__"} == set(sonarcal.__all__)
    assert len(set(sonarcal.__all__)) == len(sonarcal.__all__)
    assert {name for name in vars(_sonarcal) if not name.startswith("_")} <= set(sonarcal.__all__)


def test_keywords_of_the_stubs_are_the_options():
    classes = {node.name: [field.target.id for field in node.body]
               for node in ast.parse(STUB.with_name("_keywords.pyi").read_text()).body if isinstance(node, ast.ClassDef)}
    for _, options_class, _ in FUNCTIONS_OF.values():
        names = [option["name"] for option in options_class.describe()]
        assert classes[options_class.__name__.replace("Options", "Keywords")] == names


def test_everything_public_is_explained():
    for name in sonarcal.__all__:
        value = getattr(sonarcal, name)
        if name != "__version__":
            assert value.__doc__ and len(value.__doc__) > 20, name
    assert sonarcal.__version__ == _sonarcal.__version__


def test_arrays_are_explained_by_shape_and_unit():
    for cls in (sonarcal.PolarAxes, sonarcal.Image, sonarcal.FanImage, sonarcal.Scene, sonarcal.FrameResiduals):
        for name, member in vars(cls).items():
            if isinstance(member, property) and "shape" in (member.__doc__ or ""):
                assert re.search(r"shape \(", member.__doc__), (cls, name)
    for name, cls in (("value", sonarcal.Image), ("vertices_m", sonarcal.Scene), ("range_edges_m", sonarcal.PolarAxes)):
        assert "shape" in vars(cls)[name].__doc__


def test_docstrings_of_functions_follow_numpydoc():
    """Each parameter is listed with its type, in order, and each option after them."""
    functions = [value for value in map(sonarcal.__dict__.get, sonarcal.__all__) if isinstance(value, types.FunctionType)]
    assert len(functions) > 10
    for function in functions:
        doc = inspect.getdoc(function)
        listed = []
        for names in re.findall(r"^(\w[\w, ]*) : \S", doc, re.MULTILINE):
            listed += names.split(", ")
        assert listed == list(inspect.signature(function).parameters), function.__name__
        headings = re.findall(r"^([A-Z][\w ]+)\n-+$", doc, re.MULTILINE)
        known = ["Parameters", "Returns", "Other Parameters", "Raises", "Notes", "Examples"]
        assert headings[0] == "Parameters" and headings == [name for name in known if name in headings], headings
        assert len(doc.splitlines()[0]) <= 110 and doc.splitlines()[0].endswith(".")
