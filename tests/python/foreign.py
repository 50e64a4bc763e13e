"""Packs the unit in C of `tests/foreign` with the system's compiler."""

import subprocess
import zipfile


def pack(root, folder):
    """Writes `foreign.fmu` into the folder."""
    source, library = root / "tests/foreign", folder / "foreign.so"
    command = ["cc", "-shared", "-fPIC", "-O1", "-o", library, source / "unit.c", "-lm"]
    subprocess.run(command, check=True, timeout=60)
    with zipfile.ZipFile(folder / "foreign.fmu", "w") as archive:
        archive.write(source / "modelDescription.xml", "modelDescription.xml")
        archive.write(library, "binaries/linux64/foreign.so")
