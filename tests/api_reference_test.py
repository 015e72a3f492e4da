"""Doxygen has nothing to say against our headers, and the reference has what they declare.

    api_reference_test.py DOXYGEN DOXYFILE
"""

import pathlib
import subprocess
import sys
import tempfile


def main():
    """The test."""
    with tempfile.TemporaryDirectory() as folder:
        text = pathlib.Path(sys.argv[2]).read_text(encoding="utf-8")
        warnings = pathlib.Path(folder, "warnings.txt")
        text += f"\nOUTPUT_DIRECTORY = {folder}\nWARN_LOGFILE = {warnings}\nGENERATE_HTML = NO\nGENERATE_XML = YES\n"
        text += "XML_PROGRAMLISTING = NO\n"
        ended = subprocess.run([sys.argv[1], "-"], input=text, text=True, check=False, stdout=subprocess.DEVNULL)
        assert ended.returncode == 0
        said = warnings.read_text(encoding="utf-8")
        assert not said, said[:5000]
        index = pathlib.Path(folder, "xml", "index.xml").read_text(encoding="utf-8")
        for name in ("sonarcal::PolarImage", "sonarcal::sim::RayCaster", "sonarcal::workflow::FitOptions", "sonarcal::ParameterSet"):
            assert f"<name>{name}</name>" in index, f"{name} is not in the reference"
        # A comment at a line's end belongs to what stands before it.
        sheet = pathlib.Path(folder, "xml", "structsonarcal_1_1GsabParameters.xml").read_text(encoding="utf-8")
        assert "half-width of the specular peak" in sheet
    print("ok")


if __name__ == "__main__":
    main()
