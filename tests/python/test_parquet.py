"""`trace.parquet` read by pyarrow: it has the numbers of `trace.csv` and the column metadata of `signals.json`."""

import json

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import csv_record

TYPES = {"Real": pa.float64(), "Integer": pa.int32(), "Enumeration": pa.int32(), "Boolean": pa.bool_()}


@pytest.fixture
def folder(run_scenario):
    """The folder of a run with Reals, Integers and Booleans."""
    run, folder = run_scenario("scenarios/first_flight.scn")
    assert run.returncode == 0, run.stderr
    return folder


def test_every_value_equals_its_cell_of_the_csv_bit_for_bit(folder):
    expected = csv_record.read(folder / "trace.csv")
    table = pq.read_table(folder / "trace.parquet")
    assert table.column_names == list(expected)
    assert table.num_rows == len(expected["time"]) > 10_000
    for name, column in expected.items():
        assert table[name].null_count == 0
        assert csv_record.same_bits(table[name].to_numpy().astype(float), column), name


def test_each_column_has_its_type_and_the_metadata_of_signals_json(folder):
    schema = pq.read_schema(folder / "trace.parquet")
    signals = json.loads((folder / "signals.json").read_text())
    assert {signal["type"] for signal in signals} == {"Real", "Integer", "Boolean"}
    assert schema.field("quad.state.position.x").metadata[b"unit"] == b"m"
    for field, signal in zip(schema, signals, strict=True):
        name, kind = signal.pop("name"), signal["type"]
        assert (field.name, field.type, field.nullable) == (name, TYPES[kind], False)
        metadata = {key.decode(): value.decode() for key, value in field.metadata.items()}
        assert metadata == {key: value for key, value in signal.items() if value is not None}


def test_one_column_of_a_part_of_the_run_can_be_read_alone(folder):
    whole = csv_record.read(folder / "trace.csv")
    part = pq.read_table(folder / "trace.parquet", columns=["quad.height"], filters=[("time", ">=", 60.0)])
    assert part.column_names == ["quad.height"]
    assert csv_record.same_bits(part["quad.height"].to_numpy(), whole["quad.height"][whole["time"] >= 60.0])


def test_the_file_contains_nothing_about_its_host(folder):
    metadata = pq.read_metadata(folder / "trace.parquet")
    assert metadata.created_by == "lockstep"
    assert set(metadata.metadata) == {b"ARROW:schema"}
