"""Manual pages and completion, as man and the shells take them.

    documentation_test.py SONARCAL

man -l --warnings must have nothing to say of any page, each command of --help has its page with all options that
its --help lists, and bash offers these options, the commands, and the words of options that take one of a few. The table of
docs/reference/sonars.md is what `sonarcal sonars` lists, materials.md what `sonarcal materials` lists. The tables
and the schema of params.json in docs/reference are those that the program makes from its table of parameters. Examples of
the pages write into folders that no clone has.
"""

import functools
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SONARCAL = sys.argv[1]
PROJECT = pathlib.Path(__file__).parent.parent
REFERENCE = PROJECT / "docs" / "reference"


def output_of(*command, **more):
    """Standard output of a command that must end well."""
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, **more).stdout


@functools.cache
def options_of_help(*command):
    """Names that stand at the beginning of lines of --help."""
    names = []
    for line in output_of(SONARCAL, *command, "--help").splitlines():
        found = re.match(r"  (-\w, )?(--[\w-]+)", line)
        if found:
            names.append(found.group(2))
    return names


def completed(folder, *words):
    """What bash offers for the last word."""
    script = (
        f"source {folder}/sonarcal.bash; compopt() {{ :; }}; "
        'COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _sonarcal; printf "%s\\n" "${COMPREPLY[@]}"'
    )
    return output_of("bash", "-c", script, "bash", *words, cwd=folder).split()


def check_examples():
    """No example writes into a folder of the sources: the program would refuse it in a clone."""
    sources = {path.parent.name for path in PROJECT.glob("*/CMakeLists.txt")}
    pages = [*PROJECT.glob("*.md"), *PROJECT.glob("docs/**/*.md"), *PROJECT.glob("notebooks/*.md")]
    for page in pages:
        for out in re.findall(r"--out ([\w./-]+)", page.read_text(encoding="utf-8")):
            assert out.split("/")[0] not in sources, f"{page.name}: --out {out}"
    assert "sim" in sources and len(pages) > 20


def check_pages(folder, commands):
    """man has no complaint, and pages say what --help says."""
    for name in ["sonarcal"] + [f"sonarcal-{command}" for command in commands]:
        page = pathlib.Path(folder, f"{name}.1")
        environment = dict(os.environ, MANROFFSEQ="", MANWIDTH="80", LC_ALL="C.UTF-8")
        ended = subprocess.run(
            ["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(page)],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False, env=environment,
        )
        assert ended.returncode == 0 and not ended.stderr, f"{page.name}: {ended.stderr}"
        assert page.read_text(encoding="utf-8").count(".SH NAME") == 1
    for command in commands:
        text = pathlib.Path(folder, f"sonarcal-{command}.1").read_text(encoding="utf-8").replace("\\-", "-")
        for option in options_of_help(command):
            assert f"\\fB{option}\\fR" in text, f"sonarcal-{command}.1 does not say {option}"


def check_bash(folder, commands):
    """Commands, options, words and files."""
    assert set(commands) <= set(completed(folder, "sonarcal", ""))
    assert completed(folder, "sonarcal", "simu") == ["simulate"]
    for command in commands:
        offered = completed(folder, "sonarcal", command, "--")
        missing = set(options_of_help(command)) - set(offered)
        assert not missing, f"{command}: {missing} are not completed"
    assert completed(folder, "sonarcal", "simulate", "--sampling", "") == ["frustum", "beams"]
    assert completed(folder, "sonarcal", "export", "--to", "sto") == ["stonefish"]
    assert completed(folder, "sonarcal", "fit", "--real", "sonarcal.b") == ["sonarcal.bash"]
    assert not completed(folder, "sonarcal", "nonsense", "--")


def check_fish(folder):
    """Of each option its names, as long or as single letters."""
    text = pathlib.Path(folder, "sonarcal.fish").read_text(encoding="utf-8")
    for name in re.findall(r" -s (\S+)", text):
        assert len(name) == 1 and name.isalpha(), f"'{name}' is no single letter"
    assert "from view' -l open -l no-browser" in text


def check_sonars():
    """docs/reference/sonars.md has a row for each sonar known by name, with its figures."""
    page = REFERENCE.joinpath("sonars.md").read_text(encoding="utf-8")
    rows = {}
    for line in page.splitlines():
        if line.startswith("| `"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            rows[cells[0].strip("`")] = cells[1:]
    expected = {}
    for preset in json.loads(output_of(SONARCAL, "sonars", "--json"))["sonars"]:
        sonar = preset["sonar"]
        expected[preset["name"]] = [
            f"{sonar['frequency_hz'] / 1e6:g}",
            f"{len(sonar['beam_azimuth_deg'])}",
            sonar["beam_forming"],
            f"{preset['field_of_view_deg']:.1f}",
            f"{sonar['azimuth_beam_width_deg']:.2g}" + ("*" if "beam width" in preset["assumed"] else ""),
            f"{sonar['elevation_beam_width_deg']:g}",
            f"{sonar['range_min_m']:g}..{sonar['range_max_m']:g}",
            f"{1e3 * (sonar['range_max_m'] - sonar['range_min_m']) / sonar['range_bins']:.3g}",
        ]
    assert rows == expected, f"docs/reference/sonars.md has {rows}, the program {expected}"


def check_materials():
    """docs/reference/materials.md has the list of the program."""
    page = REFERENCE.joinpath("materials.md").read_text(encoding="utf-8")
    rows = [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in page.splitlines()
            if re.match(r"\| `[^|]*\| (acoustic|paper) \|", line)]
    listed = output_of(SONARCAL, "materials", "--list").partition("\n\n")[0].splitlines()[1:]
    expected = [re.split(r"\s{2,}", line.strip()) for line in listed]
    assert rows == expected, f"docs/reference/materials.md has {rows}, the program {expected}"


def tables_of(text):
    """The first table below each heading."""
    tables = {}
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        found = re.search(r"^\| (?:key|parameter) \|.*\n(?:\|.*\n)+", section, re.MULTILINE)
        if found:
            tables[section.partition("\n")[0]] = found.group()
    return tables


def check_parameters(folder):
    """The tables and the schema of params.json. To update them, copy from `sonarcal documentation --out`."""
    made = tables_of(pathlib.Path(folder, "parameters.md").read_text(encoding="utf-8"))
    bounds = made.pop("Default bounds")
    page = tables_of(REFERENCE.joinpath("parameters.md").read_text(encoding="utf-8"))
    assert len(made) == 9 and page.keys() == made.keys(), f"parameters.md has tables of {list(page)}"
    for heading, table in made.items():
        assert page[heading] == table, f"parameters.md, {heading}: expected\n{table}"
    page = tables_of(REFERENCE.joinpath("fit_config.md").read_text(encoding="utf-8"))
    assert page["Default bounds"] == bounds, f"fit_config.md, Default bounds: expected\n{bounds}"
    schema = "params.schema.json"
    expected = pathlib.Path(folder, schema).read_text(encoding="utf-8")
    assert REFERENCE.joinpath("schemas", schema).read_text(encoding="utf-8") == expected, f"{schema} is not up to date"


def main():
    """The test."""
    help_text = output_of(SONARCAL, "--help")
    listed = help_text.split("Start here:")[1].split("Examples")[0]
    commands = re.findall(r"^  ([\w-]+) +[A-Z]", listed, re.MULTILINE)
    assert len(commands) > 10 and "documentation" not in commands, commands
    check_sonars()
    check_materials()
    check_examples()
    with tempfile.TemporaryDirectory() as folder:
        output_of(SONARCAL, "documentation", "--out", folder)
        check_pages(folder, commands)
        check_bash(folder, commands)
        check_fish(folder)
        check_parameters(folder)
        for shell, script in (("zsh", "_sonarcal"), ("fish", "sonarcal.fish")):
            if subprocess.run(["which", shell], stdout=subprocess.DEVNULL, check=False).returncode == 0:
                subprocess.run([shell, "-n", f"{folder}/{script}"], check=True)
        for command in commands:
            for script in ("_sonarcal", "sonarcal.fish"):
                assert command in pathlib.Path(folder, script).read_text(encoding="utf-8")
    print("ok:", ", ".join(commands))


if __name__ == "__main__":
    main()
