"""The Debian package: made by cpack, unpacked into a folder, and its program run from there.

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


def main():
    """The test."""
    build = pathlib.Path(sys.argv[1])
    cpack = sys.argv[2] if len(sys.argv) > 2 else "cpack"
    with tempfile.TemporaryDirectory() as folder:
        output_of(cpack, "-G", "DEB", "--config", str(build / "CPackConfig.cmake"), "-B", folder)
        packages = list(pathlib.Path(folder).glob("*.deb"))
        assert len(packages) == 1, packages
        package = str(packages[0])
        assert re.fullmatch(r"sonarcal_[\d.]+_\w+\.deb", packages[0].name), packages[0].name

        depends = output_of("dpkg-deb", "--field", package, "Depends")
        names = {entry.split()[0].split(":")[0] for entry in re.split(r"[,|]\s*", depends.strip())}
        root = pathlib.Path(folder, "root")
        subprocess.run(["dpkg-deb", "-x", package, str(root)], check=True)
        program = root / "usr/bin/sonarcal"
        # By what the program itself asks for: a second way than dpkg-shlibdeps.
        missing = needed_packages(str(program)) - names
        assert not missing, f"{missing} are needed, Depends has {depends}"

        assert output_of(str(program), "--version").startswith("sonarcal ")
        subprocess.run([str(program), "scenes", "--only", "tank", "--quiet", "--out", f"{folder}/tank"], check=True)
        pages = sorted(path.name for path in (root / "usr/share/man/man1").iterdir())
        assert "sonarcal.1" in pages and "sonarcal-fit.1" in pages, pages
        for path in (
            "usr/share/bash-completion/completions/sonarcal",
            "usr/share/zsh/vendor-completions/_sonarcal",
            "usr/share/fish/vendor_completions.d/sonarcal.fish",
            "usr/share/sonarcal/dask_batch.py",
            "usr/share/sonarcal/cases/tank/case.json",
            "usr/share/doc/sonarcal/copyright",
            "usr/share/doc/sonarcal/guide/1_look.md",
        ):
            assert (root / path).is_file(), path
        # What belongs to building against the libraries is not in it.
        assert not (root / "usr/include").exists() and not list(root.rglob("*.a"))
        assert not list((root / "usr/bin").glob("[!s]*")), "other programs"
    print("ok:", packages[0].name, len(names), "dependencies")


if __name__ == "__main__":
    main()
