"""`trace.parquet` as pyarrow reads it: the numbers of `trace.csv`, and what `signals.json` says of each column."""

import json

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import csv_record

TYPES = {"Real": pa.float64(), "Integer": pa.int32(), "Enumeration": pa.int32(), "Boolean": pa.bool_()}


@pytest.fixture
def flight(fly):
    """The folder of a run with Reals, Integers and Booleans."""
    run, folder = fly("scenarios/first_flight.scn")
    assert run.returncode == 0, run.stderr
    return folder


def test_every_value_equals_its_cell_of_the_csv_bit_for_bit(flight):
    expected = csv_record.read(flight / "trace.csv")
    table = pq.read_table(flight / "trace.parquet")
    assert table.column_names == list(expected)
    assert table.num_rows == len(expected["time"]) > 10_000
    for name, column in expected.items():
        assert table[name].null_count == 0
        assert csv_record.same_bits(table[name].to_numpy().astype(float), column), name


def test_each_column_has_its_type_and_says_what_signals_json_says(flight):
    schema = pq.read_schema(flight / "trace.parquet")
    signals = json.loads((flight / "signals.json").read_text())
    assert {signal["type"] for signal in signals} == {"Real", "Integer", "Boolean"}
    assert schema.field("quad.state.position.x").metadata[b"unit"] == b"m"
    for field, signal in zip(schema, signals, strict=True):
        name, kind = signal.pop("name"), signal["type"]
        assert (field.name, field.type, field.nullable) == (name, TYPES[kind], False)
        told = {key.decode(): value.decode() for key, value in field.metadata.items()}
        assert told == {key: value for key, value in signal.items() if value is not None}


def test_one_column_of_a_part_of_the_flight_can_be_read_alone(flight):
    whole = csv_record.read(flight / "trace.csv")
    part = pq.read_table(flight / "trace.parquet", columns=["quad.height"], filters=[("time", ">=", 60.0)])
    assert part.column_names == ["quad.height"]
    assert csv_record.same_bits(part["quad.height"].to_numpy(), whole["quad.height"][whole["time"] >= 60.0])


def test_the_file_tells_nothing_of_its_host(flight):
    metadata = pq.read_metadata(flight / "trace.parquet")
    assert metadata.created_by == "lockstep"
    assert set(metadata.metadata) == {b"ARROW:schema"}
