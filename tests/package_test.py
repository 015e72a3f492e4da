"""The Debian packages: made by cpack, unpacked into a folder, and run from there.

    package_test.py BUILD_DIR [CPACK]
"""

import pathlib
import re
import subprocess
import sys
import tempfile


def output_of(*command):
    """Standard output of a command that must end well."""
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def needed_packages(program):
    """Debian packages of the libraries that a program asks for by itself."""
    folder = output_of("dpkg-architecture", "-qDEB_HOST_MULTIARCH").strip()
    sonames = re.findall(r"NEEDED\s+(\S+)", output_of("objdump", "-p", program))
    packages = set()
    for soname in sonames:
        search = ["dpkg", "-S", f"*/{folder}/{soname}"]
        owner = subprocess.run(search, stdout=subprocess.PIPE, text=True, check=False).stdout
        if owner:
            packages.add(owner.split(":")[0])
    return packages


def check_links(folder):
    """Each link of an installed page leads to an installed file."""
    count = 0
    for page in folder.rglob("*.md"):
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:|#", target):
                assert (page.parent / target.split("#")[0]).exists(), f"{page}: {target}"
                count += 1
    assert count > 100, count


def check_development(root, depends):
    """Headers, libraries and CMake files, and the packages that these ask for."""
    assert (root / "usr/include/sonarcal/sim/rays/trace.h").is_file()
    assert list(root.rglob("libsonarcal_sim.a")) and list(root.rglob("sonarcalConfig.cmake"))
    assert {"libeigen3-dev", "libceres-dev", "libopencv-dev", "liblz4-dev", "libzstd-dev"} <= depends, depends


def check_python(root, depends):
    """The module, its stubs, and the command that runs the program."""
    package = root / "usr/lib/python3/dist-packages"
    assert list(package.glob("sonarcal/_sonarcal.*.so")) and (package / "sonarcal/_sonarcal.pyi").is_file()
    assert {"sonarcal", "python3", "python3-numpy"} <= depends, depends
    environment = {"PYTHONPATH": str(package), "PATH": f"{root}/usr/bin:/usr/bin:/bin"}
    for arguments in (["-c", "import sonarcal; print('sonarcal', sonarcal.__version__)"],
                      ["-m", "sonarcal", "--version"]):
        run = subprocess.run(["/usr/bin/python3", "-B", *arguments], env=environment, stdout=subprocess.PIPE, text=True,
                             check=True)
        assert run.stdout.startswith("sonarcal "), run.stdout


def check_program(root, folder):
    """The program, its manual pages, completion, cases and pages."""
    program = root / "usr/bin/sonarcal"
    assert output_of(str(program), "--version").startswith("sonarcal ")
    subprocess.run([str(program), "scenes", "--only", "tank", "--quiet", "--out", f"{folder}/tank"], check=True)
    pages = sorted(path.name for path in (root / "usr/share/man/man1").iterdir())
    assert "sonarcal.1.gz" in pages and "sonarcal-fit.1.gz" in pages, pages
    assert all(page.endswith(".1.gz") for page in pages), pages
    for path in (
        "usr/share/bash-completion/completions/sonarcal",
        "usr/share/zsh/vendor-completions/_sonarcal",
        "usr/share/fish/vendor_completions.d/sonarcal.fish",
        "usr/share/sonarcal/dask_batch.py",
        "usr/share/sonarcal/cases/tank/case.json",
        "usr/share/doc/sonarcal/docs/guide/1_look.md",
        "usr/share/doc/sonarcal/docs/images/tank_frame.png",
    ):
        assert (root / path).is_file(), path
    check_links(root / "usr/share/doc/sonarcal")


def main():
    """The test."""
    build = pathlib.Path(sys.argv[1])
    cpack = sys.argv[2] if len(sys.argv) > 2 else "cpack"
    expected = ["libsonarcal-dev", "python3-sonarcal", "sonarcal"]
    with tempfile.TemporaryDirectory() as folder:
        output_of(cpack, "-G", "DEB", "--config", str(build / "CPackConfig.cmake"), "-B", folder)
        packages = sorted(pathlib.Path(folder).glob("*.deb"))
        assert [package.name.split("_")[0] for package in packages] == expected, packages
        root = pathlib.Path(folder, "root")
        depends = {}
        for package, name in zip(packages, expected):
            fields = output_of("dpkg-deb", "--field", str(package), "Depends")
            depends[name] = {entry.split()[0].split(":")[0] for entry in re.split(r"[,|]\s*", fields.strip())}
            alone = pathlib.Path(folder, name)
            for target in (alone, root):
                subprocess.run(["dpkg-deb", "-x", str(package), str(target)], check=True)
            for path in ("copyright", "changelog.gz", "THIRD_PARTY_NOTICES.md", "sonarcal.spdx.json"):
                assert (alone / "usr/share/doc" / name / path).is_file(), (name, path)
        # Compares with the libraries that the programs name, independently of dpkg-shlibdeps.
        module = next(root.rglob("_sonarcal.*.so"))
        for name, program in (("sonarcal", root / "usr/bin/sonarcal"), ("python3-sonarcal", module)):
            missing = needed_packages(str(program)) - depends[name]
            assert not missing, f"{missing} are needed, {name} depends on {depends[name]}"
        # Files for building against the libraries are in their own package only.
        alone = pathlib.Path(folder, "sonarcal")
        assert not (alone / "usr/include").exists() and not list(alone.rglob("*.a"))
        check_program(root, folder)
        check_python(root, depends["python3-sonarcal"])
        check_development(root, depends["libsonarcal-dev"])
    print("ok:", *(f"{name}: {len(names)} dependencies" for name, names in depends.items()))


if __name__ == "__main__":
    main()
