"""The stub says what the module has, Python has every option of the commands, everything public is explained."""

import ast
import inspect
import pathlib
import re

import pytest

import sonarcal
from sonarcal import _sonarcal

STUB = pathlib.Path(sonarcal.__file__).with_name("_sonarcal.pyi")
# Of every class of pybind11, or of none.
COMMON = {"__module__", "__doc__", "__weakref__", "__dict__", "__new__", "__hash__", "__init__"}


def stub_surface():
    """{name: {member: parameter names or None}} and {function: parameter names}."""
    classes, functions, values = {}, {}, set()

    def parameters(node):
        return [argument.arg for argument in node.args.args if argument.arg != "self"]

    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = parameters(node)
        elif isinstance(node, ast.AnnAssign):
            values.add(node.target.id)
        elif isinstance(node, ast.ClassDef):
            members = {}
            for member in node.body:
                if isinstance(member, ast.FunctionDef):
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
    declared = {k: v for k, v in members.items() if k not in ("__init__", "__iter__")}  # iteration goes by __getitem__
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


# Options of the commands that Python has other ways for: arguments of their own, files that are not written, what
# a shell needs, and the fits without a scene.
ELSEWHERE = {
    "simulate": {"scene", "scene-unit", "scene-up", "sonar", "params", "poses", "out", "force", "fan", "depth",
                 "resume"},
    "compare": {"real", "sim", "out", "force", "sweep-csv", "pictures", "fail-above"},
    "fit": {"real", "scene", "scene-unit", "scene-up", "params", "out", "force", "noise-only", "still", "range-min",
            "range-max", "find-background", "hold-out-bands", "reject-beyond"},
}


@pytest.mark.parametrize("command", ELSEWHERE)
def test_python_has_every_option_of_a_command(command):
    options = {name.lstrip("-") for name in _sonarcal._option_names(command)} - {"help", "h"}
    keywords = {p.name.replace("_", "-") for p in inspect.signature(getattr(sonarcal, command)).parameters.values()
                if p.kind is p.KEYWORD_ONLY} - {"progress"}
    assert keywords == options - ELSEWHERE[command]


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
