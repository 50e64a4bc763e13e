"""Locates the program and the packed units for the tests; a missing one is an error, never a skip."""

import os
import subprocess
from pathlib import Path

import pytest

from instance import Archive

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("LOCKSTEP", ROOT / "target/release/lockstep")).absolute()
PACKED = Path(os.environ.get("LOCKSTEP_FMUS", ROOT / "target/fmus")).absolute()


def unit_crates():
    """Folders of the units in this repository."""
    manifests = sorted(ROOT.glob("fmus/*/Cargo.toml"))
    return [manifest.parent for manifest in manifests if "[package.metadata.fmu]" in manifest.read_text()]


def existing(path, command):
    if not path.exists():
        raise pytest.UsageError(f"{path} is missing: `{command}` makes it, `tests/run` does it all")
    return path


def pytest_configure():
    existing(PROGRAM, "cargo build --release -p orchestrator")
    for unit in unit_crates():
        existing(PACKED / f"{unit.name}.fmu", f"lockstep pack --all --out {PACKED}")


def pytest_generate_tests(metafunc):
    """A test that asks for `unit` runs for every packed unit."""
    if "unit" in metafunc.fixturenames:
        names = sorted(path.stem for path in PACKED.glob("*.fmu"))
        metafunc.parametrize("unit", names, indirect=True)


@pytest.fixture(scope="session")
def root():
    """The repository."""
    return ROOT


@pytest.fixture(scope="session")
def packed():
    """The folder of packed units."""
    return PACKED


@pytest.fixture(scope="session")
def archives(tmp_path_factory):
    """Every packed unit by name, unpacked once."""
    folder = tmp_path_factory.mktemp("units")
    return {path.stem: Archive(path, folder / path.stem) for path in sorted(PACKED.glob("*.fmu"))}


@pytest.fixture
def unit(request, archives):
    """One packed unit."""
    return archives[request.param]


@pytest.fixture
def lockstep(tmp_path):
    """Runs the program as a user does, in the repository, on the packed units; `environment` adds variables."""

    def run(*arguments, environment=(), folder=ROOT):
        return subprocess.run(
            [PROGRAM, *map(str, arguments)], cwd=folder, env={**os.environ, "NO_COLOR": "1", **dict(environment)},
            capture_output=True, text=True, timeout=120,
        )

    return run


@pytest.fixture
def run_scenario(lockstep, tmp_path):
    """Runs a scenario on the packed units; returns the finished process and the folder of the run."""

    def run(scenario, *arguments, name="run", **keywords):
        out = tmp_path / name
        return lockstep("run", scenario, "--units", PACKED, "--out", out, *arguments, **keywords), out

    return run
