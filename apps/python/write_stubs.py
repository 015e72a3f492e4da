"""Writes the type stubs of the package. Options come from the module itself, the rest from a template.

    write_stubs.py TEMPLATE FOLDER

FOLDER holds the built module `_sonarcal`. Written there: `_sonarcal.pyi`, the template followed by the classes of
options, and `_keywords.pyi`, the options as keyword arguments.
"""

import pathlib
import sys

CLASSES = ["RayOptions", "ComparisonOptions", "SimulateOptions", "CompareOptions", "FitOptions", "LocateOptions",
           "ExplainOptions", "CalibrateOptions", "JudgeNoiseOptions", "TransferOptions"]


def stub(name, options):
    """The class of options as the module has it."""
    lines = [f"class {name}:", f"    def __init__(self, source: Union[{name}, Mapping[str, Any], None] = ..., *,"]
    lines += [f"                 {option['name']}: Optional[{option['input']}] = ...," for option in options]
    lines[-1] = lines[-1][:-1] + ") -> None: ..."
    for option in options:
        lines += ["    @property", f"    def {option['name']}(self) -> {option['output']}: ...",
                  f"    @{option['name']}.setter",
                  f"    def {option['name']}(self, value: Optional[{option['input']}]) -> None: ..."]
    lines += ["    @staticmethod", "    def describe() -> list[dict[str, Any]]: ...",
              "    def to_dict(self) -> dict[str, Any]: ...", "    def __eq__(self, other: object) -> bool: ...",
              "    def __repr__(self) -> str: ..."]
    return "\n".join(lines) + "\n"


def keywords(name, options):
    """The options as a TypedDict."""
    lines = [f"class {name.replace('Options', 'Keywords')}(TypedDict, total=False):"]
    lines += [f"    {option['name']}: Optional[{option['input']}]" for option in options]
    return "\n".join(lines) + "\n"


def main(template, folder):
    folder = pathlib.Path(folder)
    sys.path.insert(0, str(folder))
    import _sonarcal  # pylint: disable=import-outside-toplevel

    described = {name: getattr(_sonarcal, name).describe() for name in CLASSES}
    text = pathlib.Path(template).read_text(encoding="utf-8")
    imports = text[:text.index("__version__: str")]
    stubs = "\n".join(stub(name, options) for name, options in described.items())
    typed = "\n".join(keywords(name, options) for name, options in described.items())
    (folder / "_sonarcal.pyi").write_text(text + "\n" + stubs, encoding="utf-8")
    (folder / "_keywords.pyi").write_text(
        imports.replace("import Any,", "import Any, TypedDict,") + "from ._sonarcal import Parameters\n\n" + typed,
        encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
