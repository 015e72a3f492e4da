"""The notebooks run from top to bottom, and are committed as they should be."""

import ast
import json
import os
import pathlib
import subprocess
import sys
import time

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "notebooks"
NAMES = ["first_image", "fit_a_sonar", "judge_a_fit", "the_paper"]
# What a notebook may import: it teaches, and computes nothing of the field itself.
ALLOWED = {"copy", "json", "matplotlib", "numpy", "os", "pathlib", "pictures", "sonarcal", "tempfile"}


def cells(name, kind):
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == kind]


def test_these_are_all_notebooks():
    assert sorted(path.stem for path in FOLDER.glob("*.ipynb")) == sorted(NAMES)
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    for name in NAMES:
        assert f"({name}.ipynb)" in readme


@pytest.mark.parametrize("name", NAMES)
def test_outputs_are_stripped(name):
    for cell in cells(name, "code"):
        assert cell["outputs"] == [] and cell["execution_count"] is None
        assert cell["metadata"] == {}


@pytest.mark.parametrize("name", NAMES)
def test_it_reads_like_a_lesson(name):
    text = ["".join(cell["source"]) for cell in cells(name, "markdown")]
    assert text[0].startswith("# ")
    assert len(text) >= len(cells(name, "code")) / 2


@pytest.mark.parametrize("name", NAMES)
def test_it_uses_the_module_and_little_else(name):
    imported = set()
    for cell in cells(name, "code"):
        for node in ast.walk(ast.parse("".join(cell["source"]))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.split(".")[0])
    assert "sonarcal" in imported and imported <= ALLOWED


def run(name, tmp_path, recordings):
    """Runs a copy and returns its cells with their outputs."""
    environment = {**os.environ, "SONARCAL_RECORDINGS": recordings, "JUPYTER_DATA_DIR": str(tmp_path / "jupyter"),
                   "JUPYTER_CONFIG_DIR": str(tmp_path / "config"), "IPYTHONDIR": str(tmp_path / "ipython"),
                   "MPLCONFIGDIR": str(tmp_path / "mpl"), "JUPYTER_RUNTIME_DIR": str(tmp_path / "runtime")}
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "nbconvert", "--execute", "--to", "notebook", "--ExecutePreprocessor.timeout=900",
         "--ExecutePreprocessor.kernel_name=python3", "--output-dir", str(tmp_path), str(FOLDER / f"{name}.ipynb")],
        capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    print(f"{name}: {time.perf_counter() - start:.1f} s")
    executed = json.loads((tmp_path / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    return [cell for cell in executed if cell["cell_type"] == "code"]


def printed(executed):
    return "".join("".join(output.get("text", [])) for cell in executed for output in cell["outputs"]
                   if output.get("name") == "stdout")


def pictures(executed):
    return sum("image/png" in output.get("data", {}) for cell in executed for output in cell["outputs"])


@pytest.mark.parametrize("name, images", [("first_image", 4), ("judge_a_fit", 4), ("the_paper", 2)])
def test_it_runs_from_top_to_bottom(name, images, tmp_path):
    executed = run(name, tmp_path, "")
    assert all(cell["execution_count"] for cell in executed)
    assert pictures(executed) >= images
    if name != "first_image":
        assert "SYNTHETIC" in json.dumps(executed)


def test_fit_a_sonar_runs_on_a_synthetic_recording_and_says_so(tmp_path):
    text = printed(run("fit_a_sonar", tmp_path, str(tmp_path / "none")))
    assert "SYNTHETIC recording, as no real one is present" in text and "REAL" not in text


RECORDINGS = pathlib.Path(os.environ.get("SONARCAL_RECORDINGS") or FOLDER.parent / "recordings").absolute()


@pytest.mark.skipif(not (RECORDINGS / "aris3000_uxo").is_dir(),
                    reason="there is no real recording: set SONARCAL_RECORDINGS")
def test_fit_a_sonar_runs_on_a_real_recording(tmp_path):
    text = printed(run("fit_a_sonar", tmp_path, str(RECORDINGS)))
    assert "REAL recording" in text and "SYNTHETIC" not in text
