"""The walls of the house: which room may include which, and which library stays in which file.

    layering_test.py ROOT         checks the tree, one line a violation, status 1 if there are any
    layering_test.py --self-test  shows on a made-up tree that each wall holds

An include "room/file.h" is the project's own, an include <...> another library's.
"""

import pathlib
import re
import sys
import tempfile

# What a room may include besides itself.
ROOMS = {
    "data_io": set(),
    "metrics": {"data_io"},
    "sim": {"data_io"},
    "calib": {"sim", "data_io"},
    "apps": {"calib", "metrics", "sim", "data_io"},
}

# Library -> (its headers, the only files that may include them).
LIBRARIES = {
    "Embree": (r"embree\d*/", r"sim/embree_queries\.h"),
    "Embree behind its header": (r"sim/embree_queries\.h", r"sim/ray_caster\.cc"),
    "Ceres": (r"ceres/", r"calib/.*"),
    "tinygltf": (r"tiny_gltf\.h", r"data_io/scene_io\.cc"),
    "assimp": (r"assimp/", r"data_io/cad_io\.cc"),
    "librosbag": (r"ros(bag)?/", r"data_io/ros1_(chunk|bag_writer)\.cc"),
    "libarchive": (r"archive(_entry)?\.h", r"data_io/npz_writer\.cc"),
    "SQLite": (r"sqlite3\.h", r"data_io/ros2_bag\.cc"),
    "yaml-cpp": (r"yaml-cpp/", r"data_io/yaml_reader\.cc"),
    "OpenCV": (r"opencv2?/", r".*\.cc"),  # never in a header
    "CLI11": (r"CLI/", r"apps/.*"),
    "cpp-httplib": (r"httplib\.h", r"apps/view/view_server\.cc"),
}

MAX_LINES = 500  # a file that is longer does more than one thing

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def sources(root):
    for room in ROOMS:
        for path in sorted((root / room).rglob("*")):
            if path.suffix in (".h", ".cc"):
                yield room, path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def include_fault(room, name, quote, target):
    """Why a file of a room may not include the target, or None."""
    target_room = target.split("/")[0]
    if quote == '"' and target_room == "tests":
        return "what users get does not depend on tests"
    if quote == '"' and target_room in ROOMS and target_room != room and target_room not in ROOMS[room]:
        allowed = ", ".join(sorted(ROOMS[room])) or "no other room"
        return f"{room} may include {allowed}"
    for library, (headers, allowed_files) in LIBRARIES.items():
        if re.match(headers, target) and not re.fullmatch(allowed_files, name):
            return f"{library} stays within {allowed_files}"
    return None


def violations(root):
    found = []
    for room, name, text in sources(root):
        lines = text.splitlines()
        if len(lines) > MAX_LINES:
            found.append(f"{name}: {len(lines)} lines, at most {MAX_LINES}")
        for number, line in enumerate(lines, start=1):
            match = INCLUDE.match(line)
            fault = match and include_fault(room, name, *match.groups())
            if fault:
                found.append(f"{name}:{number}: includes {match.group(2)}, but {fault}")
    return found


def self_test():
    """Each line, written into its file, must or must not be a violation."""
    cases = [
        ("data_io/a.h", '#include "sim/trace.h"', True),
        ("data_io/a.h", '#include "data_io/b.h"', False),
        ("metrics/a.h", '#include "sim/trace.h"', True),
        ("metrics/a.h", '#include "data_io/types/image.h"', False),
        ("sim/a.cc", '#include "calib/fit.h"', True),
        ("sim/a.cc", '#include "metrics/iou.h"', True),
        ("calib/a.cc", '#include "metrics/iou.h"', True),
        ("calib/a.cc", '  #  include "apps/command.h"', True),
        ("calib/a.cc", '#include "sim/trace.h"', False),
        ("apps/a.cc", '#include "calib/fit.h"', False),
        ("apps/a.cc", '#include "tests/support/temp_dir.h"', True),
        ("sim/trace.cc", "#include <embree3/rtcore.h>", True),
        ("sim/trace.cc", "#include <embree4/rtcore.h>", True),
        ("sim/embree_queries.h", "#include <embree3/rtcore.h>", False),
        ("sim/trace.cc", '#include "sim/embree_queries.h"', True),
        ("sim/ray_caster.cc", '#include "sim/embree_queries.h"', False),
        ("sim/a.h", "#include <ceres/jet.h>", True),
        ("calib/a.h", "#include <ceres/jet.h>", False),
        ("data_io/mesh_io.cc", "#include <tiny_gltf.h>", True),
        ("data_io/scene_io.cc", "#include <tiny_gltf.h>", False),
        ("data_io/cad_io.h", "#include <assimp/scene.h>", True),
        ("data_io/cad_io.cc", "#include <assimp/scene.h>", False),
        ("data_io/ros1_bag.cc", "#include <rosbag/bag.h>", True),
        ("data_io/ros1_chunk.cc", "#include <rosbag/chunked_file.h>", False),
        ("data_io/bag.cc", "#include <sqlite3.h>", True),
        ("data_io/ros2_bag.cc", "#include <sqlite3.h>", False),
        ("data_io/camera_io.cc", "#include <yaml-cpp/yaml.h>", True),
        ("data_io/yaml_reader.cc", "#include <yaml-cpp/yaml.h>", False),
        ("data_io/a.h", "#include <opencv2/core.hpp>", True),
        ("data_io/a.cc", "#include <opencv2/core.hpp>", False),
        ("sim/a.cc", "#include <CLI/CLI.hpp>", True),
        ("sim/a.cc", '// #include "calib/fit.h"', False),
        ("sim/long.cc", "\n" * (MAX_LINES + 1), True),
        ("sim/long.cc", "\n" * MAX_LINES, False),
    ]
    wrong = []
    for name, text, is_violation in cases:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True)
            path.write_text(text + "\n" if text.strip() else text, encoding="utf-8")
            if bool(violations(pathlib.Path(folder))) != is_violation:
                wrong.append(f"{name}: {text.strip()[:60]!r}: expected {'a' if is_violation else 'no'} violation")
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
            found = [f"{root}: no sources, expected the rooms {', '.join(ROOMS)}"]
    for line in found:
        print(line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
