"""The messages that a zenoh client receives from a run, and that watching has no effect on the run."""

import contextlib
import csv
import json
import os
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest
import zenoh

from conftest import PACKED, PROGRAM, ROOT

PATIENCE_S = 60
SCRIPT = ROOT / "scenarios/first_flight.scn"
INSTANCES = ("path", "air", "ctrl", "quad")


class LiveRun:
    """A running process that can be watched."""

    def __init__(self, out, *arguments, open_files=None):
        self.out = out
        command = [PROGRAM, "run", SCRIPT, "--units", PACKED, "--out", out, *arguments]
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (open_files or before[0], before[1]))
        self.process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
        self.said = ""
        while not (match := re.search(r"^live: run (\w+) at (\S+)\nhelp: watch it with (.*)\n", self.said, re.MULTILINE)):
            line = self.process.stderr.readline()
            assert line, self.said
            self.said += line
        self.run, self.address, self.hint = match.groups()

    def end(self):
        """Waits for the end; returns the standard error."""
        _, rest = self.process.communicate(timeout=PATIENCE_S)
        self.said += rest
        return self.said

    def interrupt(self):
        """Interrupts the run after its current step; returns the standard error."""
        self.process.send_signal(signal.SIGINT)
        return self.end()

    def peak_memory(self):
        """The most bytes of memory that it has taken so far."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return 1024 * int(re.search(r"VmHWM:\s+(\d+) kB", status)[1])

    def rows(self):
        """The trace's rows by tick."""
        with open(self.out / "trace.csv", newline="") as file:
            return dict(enumerate(csv.DictReader(file)))


class Watcher:
    """A client that collects the received messages as (key, encoding, message)."""

    def __init__(self, address, keys="lockstep/**"):
        settings = {"mode": "client", "connect": {"endpoints": [address]}}
        self.session = zenoh.open(zenoh.Config.from_json5(json.dumps(settings)))
        self.seen = []
        self.session.declare_subscriber(keys, self.see)

    def see(self, sample):
        self.seen.append((str(sample.key_expr), str(sample.encoding), json.loads(sample.payload.to_string())))

    def values(self, instance):
        return [message for key, _, message in self.seen if key.endswith(f"/live/{instance}")]

    def states(self):
        return [message for key, _, message in self.seen if key.endswith("/live")]

    def await_end(self):
        until(lambda: self.states() and self.states()[-1]["state"] != "running")


@pytest.fixture
def launch(tmp_path):
    """Starts runs that can be watched; those still running at the end of the test are killed."""
    runs = []

    def start(*arguments, name="run", **limits):
        runs.append(LiveRun(tmp_path / name, *arguments, **limits))
        return runs[-1]

    yield start
    for live in runs:
        live.process.kill()


@pytest.fixture
def watch():
    """Clients that are closed at the end."""
    with contextlib.ExitStack() as stack:

        def start(*arguments):
            watcher = Watcher(*arguments)
            stack.enter_context(watcher.session)
            return watcher

        yield start


def until(condition):
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def bits(number):
    return struct.pack("<d", float(number))


def assert_as_in_trace(messages, instance, rows):
    """Asserts that every value of every message equals that of the trace at its tick, bit for bit."""
    for message in messages:
        row = rows[message["tick"]]
        assert bits(message["time"]) == bits(row["time"])
        columns = {name for name in row if name.startswith(f"{instance}.")}
        assert {f"{instance}.{variable}" for variable in message["values"]} == columns
        for variable, value in message["values"].items():
            assert bits(value) == bits(row[f"{instance}.{variable}"]), (message["tick"], variable)


@pytest.mark.parametrize("placement", [(), ("--isolate",)])
def test_a_sample_of_the_rows_is_published_bit_for_bit_and_the_last_row_always(launch, watch, placement):
    live = launch("--live", "--pace", "1", *placement)
    watcher = watch(live.address)
    until(lambda: len(watcher.values("quad")) >= 30)
    live.interrupt()
    watcher.await_end()
    assert {key.split("/")[1] for key, _, _ in watcher.seen} == {live.run}
    assert {message["run"] for _, _, message in watcher.seen} == {live.run}
    assert {encoding for _, encoding, _ in watcher.seen} == {"application/json"}
    rows = live.rows()
    wall_s = json.loads((live.out / "run.json").read_text())["wall_s"]
    for instance in INSTANCES:
        seen = watcher.values(instance)
        assert_as_in_trace(seen, instance, rows)
        ticks = [message["tick"] for message in seen]
        assert ticks == sorted(set(ticks)) and ticks[-1] == max(rows)
        assert len(ticks) < len(rows) and len(ticks) <= 50 * wall_s + 2


def test_the_schema_describes_the_values(launch, watch):
    live = launch("--live", "--pace", "1")
    watcher = watch(live.address)
    replies = [reply.ok for reply in watcher.session.get("lockstep/*/schema/*")]
    schemas = {str(reply.key_expr).split("/")[-1]: json.loads(reply.payload.to_string()) for reply in replies}
    assert {str(reply.encoding) for reply in replies} == {"application/json"}
    until(lambda: all(map(watcher.values, INSTANCES)))
    live.interrupt()
    signals = json.loads((live.out / "signals.json").read_text())
    assert set(schemas) == set(INSTANCES)
    kinds = {"Real": float, "Boolean": bool, "Integer": int, "Enumeration": int}
    for instance, schema in schemas.items():
        assert schema == [entry for entry in signals if entry["instance"] == instance]
        for message in watcher.values(instance):
            assert list(message["values"]) == [entry["variable"] for entry in schema]
            for entry in schema:
                assert type(message["values"][entry["variable"]]) is kinds[entry["type"]]


def test_a_run_is_discovered_and_publishes_the_state_of_its_claims_until_its_end(launch, watch):
    live = launch("--live", "--pace", "20")
    watcher = watch(live.address, "lockstep/*/live")
    live.end()
    watcher.await_end()
    first, *_, last = watcher.states()
    assert first["state"] == "running" and {claim["verdict"] for claim in first["claims"]} == {None}
    assert (last["run"], last["state"], last["tick"], last["time"]) == (live.run, "finished", 16800, 84.0)
    verdicts = json.loads((live.out / "verdict.json").read_text())["claims"]
    keys = ("name", "verdict", "margin", "unit")
    assert last["claims"] == [{key: claim[key] for key in keys} for claim in verdicts]


def test_a_broken_run_publishes_its_state(launch, watch):
    live = launch("--live", "--pace", "1")
    watcher = watch(live.address)
    until(watcher.states)
    number = live.process.pid
    children = [(task / "children").read_text().split() for task in Path(f"/proc/{number}/task").iterdir()]
    os.kill(int(sum(children, [])[0]), signal.SIGKILL)
    assert "SIGKILL" in live.end()
    watcher.await_end()
    assert watcher.states()[-1]["state"] == "broken"


def test_every_tick_is_published_if_requested(launch, watch):
    live = launch("--live-every-tick", "--pace", "1")
    watcher = watch(live.address)
    until(lambda: len(watcher.values("quad")) >= 300)
    assert "--pace slows" not in live.interrupt()
    watcher.await_end()
    rows = live.rows()
    for instance in INSTANCES:
        seen = watcher.values(instance)
        assert_as_in_trace(seen, instance, rows)
        ticks = [message["tick"] for message in seen]
        assert ticks == list(range(ticks[0], max(rows) + 1))


def test_rows_are_published_in_a_run_that_records_nothing(launch, watch):
    recorded = launch("--live", name="recorded")
    recorded.end()
    live = launch("--live", "--pace", "1", "--record", "none")
    watcher = watch(live.address)
    until(lambda: len(watcher.values("quad")) >= 10)
    live.interrupt()
    watcher.await_end()
    assert not (live.out / "trace.csv").exists()
    assert_as_in_trace(watcher.values("quad"), "quad", recorded.rows())


def test_messages_of_a_watcher_reach_neither_another_watcher_nor_the_run(launch, watch):
    calm = launch("--live", name="calm")
    calm.end()
    live = launch("--live", "--pace", "20")
    watcher, other = watch(live.address), watch(live.address)
    until(lambda: watcher.values("quad") and other.values("quad"))
    lie = json.dumps({"run": "a lie", "tick": 1, "state": "broken"})
    for key in (f"lockstep/{live.run}/live/quad", f"lockstep/{live.run}/live", f"lockstep/{live.run}/do"):
        other.session.put(key, lie, encoding="application/json")
    live.end()
    watcher.await_end()
    # The client's own subscriber receives the message, so it was sent.
    assert "a lie" in {message["run"] for _, _, message in other.seen}
    assert "a lie" not in {message["run"] for _, _, message in watcher.seen}
    assert watcher.states()[-1]["state"] == "finished"
    for file in ("trace.csv", "signals.json", "verdict.json"):
        assert (live.out / file).read_bytes() == (calm.out / file).read_bytes()


STOPPED = """
import json, sys, time, zenoh
settings = {"mode": "client", "connect": {"endpoints": [sys.argv[1]]}}
session = zenoh.open(zenoh.Config.from_json5(json.dumps(settings)))
session.declare_subscriber("**", lambda sample: print("seen", flush=True))
time.sleep(600)
"""


def test_thirty_watchers_and_a_stopped_one_neither_change_nor_delay_a_run(launch, watch):
    alone = launch("--live", name="alone")
    alone.end()
    watched = launch("--live-every-tick", "--pace", "20", name="watched")
    watchers = [watch(watched.address) for _ in range(30)]
    stopped = subprocess.Popen([sys.executable, "-c", STOPPED, watched.address], stdout=subprocess.PIPE, text=True)
    try:
        assert stopped.stdout.readline() == "seen\n"
        stopped.send_signal(signal.SIGSTOP)
        watched.end()
    finally:
        stopped.kill()
    assert watched.process.returncode == 0
    # At 20 times real time 84 s take 4.2 s; each put that waited for the stopped watcher would take 5 s more.
    assert json.loads((watched.out / "run.json").read_text())["wall_s"] < 4.2 + 5
    for file in ("trace.csv", "signals.json", "verdict.json"):
        assert (watched.out / file).read_bytes() == (alone.out / file).read_bytes()
    assert all(watcher.values("quad") for watcher in watchers)


def connect_often(address):
    """Opens 1,000 connections that say nothing; more than a run may have descriptors by default."""
    host, port = address.removeprefix("tcp/").split(":")
    allowed = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (allowed, allowed))
    return [socket.create_connection((host, int(port))) for _ in range(1000)]


def put_much(address):
    """Sends two messages of 200 MB, which is more than the run may put together before it rejects them."""
    watchers = [Watcher(address, "none") for _ in range(2)]
    for watcher in watchers:
        watcher.session.put("lockstep/a/live", bytes(200 << 20), congestion_control=zenoh.CongestionControl.BLOCK)
    return [watcher.session for watcher in watchers]


@pytest.mark.parametrize("flood", [connect_often, put_much])
@pytest.mark.parametrize("placement", [(), ("--isolate",)])
def test_a_flood_changes_no_byte_and_takes_little_memory(launch, flood, placement, tmp_path):
    calm = launch("--live", name="calm")
    calm.end()
    live = launch("--live", "--pace", "1", "--save-at", "2s", tmp_path / "saved", *placement, name="flooded", open_files=256)
    before = live.peak_memory()
    with contextlib.ExitStack() as stack:
        for connection in flood(live.address):
            stack.enter_context(connection)
        until(lambda: len((live.out / "trace.csv.partial").read_bytes().splitlines()) > 500)
        assert live.peak_memory() - before < 64 << 20
        live.interrupt()
    assert live.process.returncode == 130 and (tmp_path / "saved").exists(), live.said
    so_far = (live.out / "trace.csv").read_bytes()
    assert (calm.out / "trace.csv").read_bytes().startswith(so_far)


def test_the_name_of_a_run_is_in_none_of_its_results(launch):
    live = launch("--live")
    live.end()
    contents = [path.read_bytes() for path in live.out.iterdir()]
    assert len(contents) == 5 and not any(live.run.encode() in content for content in contents)


def test_the_example_of_the_documentation_prints_positions_of_the_trace(launch, tmp_path):
    page = (ROOT / "docs/watching.md").read_text()
    example = tmp_path / "position.py"
    example.write_text(page.split("```python\n")[1].split("```")[0])
    live = launch("--live", "--pace", "1")
    with subprocess.Popen([sys.executable, example, live.address], stdout=subprocess.PIPE, text=True) as watching:
        lines = [watching.stdout.readline() for _ in range(3)]
        live.interrupt()
        lines += watching.communicate(timeout=PATIENCE_S)[0].splitlines()
    assert watching.returncode == 0
    rows = {bits(row["time"]): row for row in live.rows().values()}
    for line in lines:
        time_s, *position = re.fullmatch(r"(\S+) s: (\S+) (\S+) (\S+) m\n?", line).groups()
        row = rows[bits(time_s)]
        assert list(map(bits, position)) == [bits(row[f"quad.state.position.{axis}"]) for axis in "xyz"]
    assert row is list(rows.values())[-1]


def test_the_printed_command_shows_the_run(launch):
    live = launch("--live", "--pace", "1")
    programs = f"{os.path.dirname(sys.executable)}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": programs, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(["sh", "-c", f"exec {live.hint}"], env=environment, stdout=subprocess.PIPE, text=True) as pasted:
        printed = pasted.stdout.readline()
        pasted.kill()
    assert re.match(rf'lockstep/{live.run}/live(/\w+)? {{"run":"{live.run}","tick":\d+', printed), printed


def test_an_endpoint_in_use_is_an_error_before_the_run(launch, run_scenario):
    live = launch("--live", "--pace", "1")
    refused, folder = run_scenario("scenarios/breeze.scn", f"--live={live.address}", name="refused")
    assert refused.returncode == 2 and not folder.exists()
    error = rf"error: cannot listen at {live.address} for those who watch: .*in use \(os error \d+\).*\nhelp: .*\n"
    assert re.fullmatch(error, refused.stderr) and ".rs" not in refused.stderr, refused.stderr


def test_an_endpoint_that_is_open_to_other_machines_causes_a_warning(launch):
    live = launch("--live=tcp/0.0.0.0:0")
    assert "is open to other machines: anybody who reaches it can watch this run" in live.end()
