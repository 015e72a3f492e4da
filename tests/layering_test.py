"""The walls of the house: which folder includes which, which file includes a library, which constants differ in name.

    layering_test.py ROOT         checks the tree, one line a violation, status 1 if there are any
    layering_test.py --self-test  shows on a made-up tree that each wall holds

An include "folder/file.h" is the project's own, an include <...> another library's.
"""

import pathlib
import re
import sys
import tempfile

# A folder may include itself and the folders above it, so there is no cycle.
FOLDERS = [
    "core/types",
    "core/text",
    "core/math",
    "core/imaging",
    "core/sonars",
    "core/materials",
    "data_io/files",
    "data_io/json",
    "data_io/images",
    "data_io/scenes",
    "data_io/pictures",
    "data_io/parameters",
    "data_io/recordings",
    "data_io/sonars",
    "data_io/mcap",
    "data_io/ros",
    "data_io/bag_writers",
    "data_io",
    "metrics/segmentation",
    "metrics/measures",
    "metrics",
    "metrics/task",
    "metrics/json",
    "sim/physics",
    "sim/rays/row_math",
    "sim/rays",
    "sim/paper",
    "sim/acoustic",
    "sim/ghosts",
    "sim/coherent",
    "sim/scenes",
    "sim",
    "sim/gathered",
    "calib/shapes",
    "calib/parameters",
    "calib/models",
    "calib/paper",
    "calib/poses",
    "calib",
    "calib/noise",
    "calib/standard_target",
    "calib/selection",
    "calib/markers",
    "apps/workflow/materials",
    "apps/workflow/rays",
    "apps/workflow",
    "apps/workflow/parts",
    "apps/workflow/calibration",
    "apps/workflow/noise",
    "apps/workflow/task",
    "apps/report/html",
    "apps/report/pictures",
    "apps/report/sections",
    "apps/report/detection",
    "apps/export",
    "apps/cli/documentation",
    "apps/cli",
    "apps/reproduce",
    "apps/batch",
    "apps/view",
    "apps/commands",
    "apps/commands/fitting",
    "apps/python",
]

# Libraries that stand side by side: neither may include the other.
APART = [("metrics", "sim"), ("metrics", "calib")]

# Touch no file: nobody who links them gets the libraries of data_io.
WITHOUT_FILES = ["metrics/segmentation", "metrics/measures", "metrics", "metrics/task"] + [f for f in FOLDERS if f.startswith("sim")]

MAX_FILES = 30  # in a folder, so that a newcomer can read its list

# Library -> (its headers, the only files that may include them).
LIBRARIES = {
    "Embree": (r"embree\d*/", r"sim/rays/embree_queries\.h"),
    "Embree behind its header": (r"sim/rays/embree_queries\.h", r"sim/rays/ray_caster\.cc"),
    "Ceres": (r"ceres/", r"calib/.*"),
    "Boost": (r"boost/", r"sim/physics/k_law\.cc"),
    "tinygltf": (r"tiny_gltf\.h", r"data_io/scenes/scene_io\.cc"),
    "libarchive": (r"archive(_entry)?\.h", r"data_io/.*/npz_writer\.cc"),
    "bzip2, lz4 and zstd": (r"(bzlib|lz4frame|zstd)\.h", r"data_io/files/compression\.cc"),
    "SQLite": (r"sqlite3\.h", r"data_io/ros/ros2_bag\.cc"),
    "yaml-cpp": (r"yaml-cpp/", r"data_io/.*/yaml_reader\.cc"),
    "OpenCV": (r"opencv2?/", r".*\.cc"),  # never in a header
    "CLI11": (r"CLI/", r"apps/.*"),
    "cpp-httplib": (r"httplib\.h", r"apps/view/view_server\.cc"),
}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
CONSTANT = re.compile(r"^(?:inline )?(?:constexpr|const) [^=({]*?\b(k[A-Z]\w*)(?:\[\w*\])*\s*[={]", re.MULTILINE)
SUFFIXES = (".h", ".cc")


def sources(root):
    for library in sorted({folder.split("/")[0] for folder in FOLDERS}):
        for path in sorted((root / library).rglob("*")):
            if path.suffix in SUFFIXES:
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def folder_of(name):
    """The entry of FOLDERS that a file lies in, or None."""
    folder = name.rpartition("/")[0]
    return folder if folder in FOLDERS else None


def include_fault(name, quote, target):
    """Why a file may not include the target, or None."""
    if quote == '"' and target.startswith("tests/"):
        return "what users get does not depend on tests"
    here, there = folder_of(name), folder_of(target)
    if quote == '"' and here and there:
        if FOLDERS.index(there) > FOLDERS.index(here):
            return f"{there} stands below {here} in the list of folders"
        if {here.split("/")[0], there.split("/")[0]} in [set(pair) for pair in APART]:
            return f"{here} and {there} stand side by side"
        if here in WITHOUT_FILES and there.startswith("data_io"):
            return f"{here} touches no file"
    for library, (headers, allowed_files) in LIBRARIES.items():
        if re.match(headers, target) and not re.fullmatch(allowed_files, name):
            return f"{library} stays within {allowed_files}"
    return None


def hiding_constants(root):
    """Constants of sources with the name of a header's constant.

    Where several sources are compiled at a time (SONARCAL_UNITY), the others may take one constant for the other.
    """
    texts = {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for library in {*(folder.split("/")[0] for folder in FOLDERS), "tests"} for path in (root / library).rglob("*")
        if path.suffix in SUFFIXES
    }
    header_of = {constant: name for name, text in texts.items() if name.endswith(".h") for constant in CONSTANT.findall(text)}
    for name, text in sorted(texts.items()):
        for constant in CONSTANT.findall(text) if name.endswith(".cc") else ():
            if constant in header_of:
                yield f"{name}: {constant} hides that of {header_of[constant]}"


def violations(root):
    found = list(hiding_constants(root))
    files_in = {}
    for name, text in sources(root):
        folder = name.rpartition("/")[0]
        files_in[folder] = files_in.get(folder, 0) + 1
        if folder_of(name) is None:
            found.append(f"{name}: its folder is not in the list of {pathlib.Path(__file__).name}")
        for number, line in enumerate(text.splitlines(), start=1):
            match = INCLUDE.match(line)
            fault = match and include_fault(name, *match.groups())
            if fault:
                found.append(f"{name}:{number}: includes {match.group(2)}, but {fault}")
    for folder, count in files_in.items():
        if count > MAX_FILES:
            found.append(f"{folder}: {count} files, at most {MAX_FILES}")
    return found


def is_violation(files):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text + "\n", encoding="utf-8")
        return bool(violations(pathlib.Path(folder)))


def self_test():
    """Each line, written into its file, must or must not be a violation."""
    cases = [
        ("core/types/a.h", '#include "core/math/b.h"', True),
        ("core/math/a.h", '#include "core/types/b.h"', False),
        ("data_io/a.h", '#include "sim/rays/trace.h"', True),
        ("data_io/files/a.h", '#include "data_io/open_recording.h"', True),
        ("data_io/a.h", '#include "data_io/files/b.h"', False),
        ("metrics/a.h", '#include "sim/rays/trace.h"', True),
        ("sim/a.h", '#include "metrics/iou.h"', True),
        ("metrics/a.h", '#include "core/types/image.h"', False),
        ("sim/a.cc", '#include "data_io/pose_io.h"', True),
        ("metrics/measures/a.cc", '#include "data_io/pose_io.h"', True),
        ("metrics/json/a.cc", '#include "data_io/json/json_writer.h"', False),
        ("sim/a.cc", '#include "calib/fit.h"', True),
        ("calib/a.cc", '#include "metrics/iou.h"', True),
        ("calib/a.cc", '  #  include "apps/cli/command.h"', True),
        ("calib/a.cc", '#include "sim/rays/trace.h"', False),
        ("calib/models/a.cc", '#include "calib/fit.h"', True),
        ("apps/workflow/a.cc", '#include "calib/fit.h"', False),
        ("apps/view/a.cc", '#include "apps/cli/b.h"', False),
        ("apps/workflow/a.cc", '#include "apps/cli/b.h"', True),
        ("apps/cli/a.cc", '#include "tests/support/temp_dir.h"', True),
        ("sim/rays/trace.cc", "#include <embree3/rtcore.h>", True),
        ("sim/rays/trace.cc", "#include <embree4/rtcore.h>", True),
        ("sim/rays/embree_queries.h", "#include <embree3/rtcore.h>", False),
        ("sim/rays/trace.cc", '#include "sim/rays/embree_queries.h"', True),
        ("sim/rays/ray_caster.cc", '#include "sim/rays/embree_queries.h"', False),
        ("sim/a.h", "#include <ceres/jet.h>", True),
        ("calib/a.h", "#include <ceres/jet.h>", False),
        ("data_io/scenes/mesh_io.cc", "#include <tiny_gltf.h>", True),
        ("data_io/scenes/scene_io.cc", "#include <tiny_gltf.h>", False),
        ("data_io/ros/bag.cc", "#include <bzlib.h>", True),
        ("data_io/files/compression.cc", "#include <bzlib.h>", False),
        ("data_io/ros/bag.cc", "#include <sqlite3.h>", True),
        ("data_io/ros/ros2_bag.cc", "#include <sqlite3.h>", False),
        ("data_io/parameters/camera_io.cc", "#include <yaml-cpp/yaml.h>", True),
        ("data_io/files/yaml_reader.cc", "#include <yaml-cpp/yaml.h>", False),
        ("data_io/a.h", "#include <opencv2/core.hpp>", True),
        ("data_io/a.cc", "#include <opencv2/core.hpp>", False),
        ("sim/a.cc", "#include <CLI/CLI.hpp>", True),
        ("sim/a.cc", '// #include "calib/fit.h"', False),
        ("sim/elsewhere/a.cc", "", True),
    ]
    wrong = [
        f"{name}: {text.strip()[:60]!r}: expected {'a' if expected else 'no'} violation"
        for name, text, expected in cases
        if is_violation({name: text}) != expected
    ]
    header = {"sim/a.h": "inline constexpr int kBins = 3;"}
    for text, expected in (("constexpr double kBins[] = {1.0};", True),
                           ("constexpr std::array<int, kBins> kRows = {};", False)):
        if is_violation({**header, "tests/sim/a.cc": text}) != expected:
            wrong.append(f"tests/sim/a.cc: {text!r}: expected {'a' if expected else 'no'} violation")
    for count, expected in ((MAX_FILES, False), (MAX_FILES + 1, True)):
        if is_violation({f"sim/{i}.cc": "" for i in range(count)}) != expected:
            wrong.append(f"{count} files in a folder: expected {'a' if expected else 'no'} violation")
    return wrong


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        found = self_test()
    else:
        root = pathlib.Path(sys.argv[1])
        found = violations(root)
        if not any(True for _ in sources(root)):
            found = [f"{root}: no sources, expected the folders {', '.join(FOLDERS)}"]
    for line in found:
        print(line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
