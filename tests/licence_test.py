"""The software bill of materials, and what `sonarcal --licenses` prints.

    licence_test.py BUILD_DIR SONARCAL CMAKE GENERATOR

The SPDX file is complete and its relationships name its elements. It lists each package that CMake found, and each
shared library that the program needs. Libraries whose code is compiled in have a notice. CMake refuses a package
without an entry, lists no library of a part that is not built, and writes the same file again.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BUILD, SONARCAL, CMAKE, GENERATOR = sys.argv[1:]
PROJECT = pathlib.Path(__file__).parent.parent

DOCUMENT_FIELDS = ["spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo"]
PACKAGE_FIELDS = ["SPDXID", "name", "versionInfo", "downloadLocation", "filesAnalyzed", "licenseDeclared"]
USES = {"linked": "DYNAMIC_LINK", "linked statically": "STATIC_LINK", "compiled in": "CONTAINS", "embedded": "CONTAINS"}

# Runtime libraries of C and C++, and of the sanitizers.
RUNTIME = r"ld-linux.*|lib(c|m|mvec|stdc\+\+|gcc_s|pthread|dl|rt|asan|tsan|ubsan)"
# Names of shared libraries that differ from the name in the list.
LIBRARIES = {
    r"archive": "libarchive",
    r"bz2": "bzip2",
    r"ceres": "Ceres Solver",
    r"cholmod": "SuiteSparse CHOLMOD",
    r"crypto|ssl": "OpenSSL",
    r"embree.*": "Embree",
    r"f77blas": "ATLAS",
    r"opencv_.*": "OpenCV",
    r"png.*": "libpng",
    r"spqr": "SuiteSparse SPQR",
    r"sqlite3": "SQLite",
    r"tbb": "oneTBB",
    r"tiff": "LibTIFF",
    r"z": "zlib",
    r"zstd": "Zstandard",
}


def output_of(*command):
    """Standard output of a command that must end well."""
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def configure(folder, *options):
    """Configures the project without its tests at a fixed time."""
    environment = dict(os.environ, SOURCE_DATE_EPOCH="86400")
    command = [CMAKE, "-S", str(PROJECT), "-B", folder, "-G", GENERATOR, "-DSONARCAL_BUILD_TESTS=OFF", *options]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False,
                          env=environment)


def check_document(document):
    """Required fields of SPDX 2.3."""
    for field in DOCUMENT_FIELDS:
        assert document.get(field), field
    assert document["spdxVersion"] == "SPDX-2.3" and document["dataLicense"] == "CC0-1.0"
    assert document["SPDXID"] == "SPDXRef-DOCUMENT"
    assert re.fullmatch(r"https://spdx\.org/spdxdocs/sonarcal-[\d.]+-[\da-f-]{36}", document["documentNamespace"])
    created = document["creationInfo"]["created"]
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", created), created
    assert all(re.match(r"(Organization|Tool): \S", creator) for creator in document["creationInfo"]["creators"])
    packages = document["packages"]
    for package in packages:
        for field in PACKAGE_FIELDS:
            assert package.get(field) not in (None, ""), f"{package['name']}: {field}"
        assert re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]), package["SPDXID"]
    assert packages[0]["name"] == "sonarcal" and packages[0]["licenseDeclared"] == "Apache-2.0"
    assert len({package["name"] for package in packages}) == len(packages)


def check_relationships(document):
    """Each names elements of the document, and each library has the one of its use."""
    ids = [document["SPDXID"]] + [package["SPDXID"] for package in document["packages"]]
    assert len(set(ids)) == len(ids)
    triples = [tuple(relationship[key] for key in ("spdxElementId", "relationshipType", "relatedSpdxElement"))
               for relationship in document["relationships"]]
    for element, _, related in triples:
        assert element in ids and related in ids, f"{element} and {related}"
    program = document["packages"][0]["SPDXID"]
    assert ("SPDXRef-DOCUMENT", "DESCRIBES", program) in triples
    for package in document["packages"][1:]:
        use = package["sourceInfo"].split(",")[0]
        assert (program, USES[use], package["SPDXID"]) in triples, package["name"]


def check_found(document):
    """Each package that the build finds has an entry."""
    text = PROJECT.joinpath("cmake", "SonarcalDependencies.cmake").read_text(encoding="utf-8")
    found = set(re.findall(r"^\s*sonarcal_find\(([\w-]+)", text, re.MULTILINE)) - {"Threads"}
    sources = " ".join(package.get("sourceInfo", "") for package in document["packages"])
    listed = set(re.findall(r"find_package\(([\w-]+)\)", sources))
    assert len(found) > 15 and found <= listed, f"{found - listed} have no entry"


def check_needed(names):
    """Each shared library that the program asks for by itself belongs to an entry."""
    for soname in re.findall(r"NEEDED\s+(\S+)", output_of("objdump", "-p", SONARCAL)):
        stem = soname.split(".so")[0]
        if re.fullmatch(RUNTIME, stem):
            continue
        stem = re.sub(r"^lib", "", stem)
        name = next((name for pattern, name in LIBRARIES.items() if re.fullmatch(pattern, stem)), stem)
        assert name.lower() in {listed.lower() for listed in names}, f"{soname} has no entry"


def check_notices(document):
    """Libraries whose code is in the program have a notice."""
    notices = PROJECT.joinpath("THIRD_PARTY_NOTICES.md").read_text(encoding="utf-8")
    for package in document["packages"][1:]:
        if not re.match(r"linked(,|$)", package["sourceInfo"]):
            assert package["name"] in notices, f"THIRD_PARTY_NOTICES.md does not name {package['name']}"


def check_program(document):
    """--licenses prints all texts and the table; --version prints one line."""
    text = output_of(SONARCAL, "--licenses")
    version = output_of(SONARCAL, "--version")
    assert version == f"sonarcal {document['packages'][0]['versionInfo']}\n", version
    assert text.startswith(version)
    for name in ("LICENSE", "THIRD_PARTY_NOTICES.md"):
        assert PROJECT.joinpath(name).read_text(encoding="utf-8") in text, f"--licenses does not print {name}"
    table = [re.split(r"\s{2,}", line) for line in text.rpartition("\n\n")[2].splitlines()]
    expected = [
        [package["name"], package["versionInfo"], package["sourceInfo"].split(",")[0], package["licenseDeclared"]]
        for package in document["packages"][1:]
    ]
    assert sorted(table[1:]) == sorted(expected), f"the table is {table}, expected {expected}"
    assert output_of(SONARCAL, "--version", "--licenses") == text
    assert output_of(SONARCAL, "--licenses", "--version") == text


def check_configuration():
    """Parts that are not built, the same file twice, and a package without an entry."""
    with tempfile.TemporaryDirectory() as folder:
        parts = [f"-DSONARCAL_WITH_{part}=OFF" for part in ("ROS", "VIEW", "MARKERS", "PYTHON")]
        texts = []
        for name in ("first", "second"):
            ended = configure(f"{folder}/{name}", *parts)
            assert ended.returncode == 0, ended.stderr
            texts.append(pathlib.Path(folder, name, "sonarcal.spdx.json").read_text(encoding="utf-8"))
        assert texts[0] == texts[1]
        document = json.loads(texts[0])
        assert document["creationInfo"]["created"] == "1970-01-02T00:00:00Z"
        check_document(document)
        check_relationships(document)
        names = {package["name"] for package in document["packages"]}
        assert {"Eigen", "CLI11"} <= names
        assert not {"SQLite", "cpp-httplib", "three.js", "pybind11"} & names, names
        ended = configure(f"{folder}/unlisted", *parts, "-DSONARCAL_FOUND_PACKAGES=BISON")
        assert ended.returncode != 0 and "BISON has no entry" in ended.stderr, ended.stderr


def main():
    """The test."""
    document = json.loads(pathlib.Path(BUILD, "sonarcal.spdx.json").read_text(encoding="utf-8"))
    check_document(document)
    check_relationships(document)
    check_found(document)
    names = [package["name"] for package in document["packages"]]
    check_needed(names)
    check_notices(document)
    check_program(document)
    check_configuration()
    print(f"ok: {len(names) - 1} libraries")


if __name__ == "__main__":
    main()
