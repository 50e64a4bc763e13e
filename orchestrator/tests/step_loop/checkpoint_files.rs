//! Valid and invalid checkpoint files.

use crate::checkpoints::everything;
use crate::fake::description;
use orchestrator::run::step_loop::Checkpoint;
use proptest::prelude::*;
use results::checkpoint::{CheckpointError, FORMAT, Identity, MAGIC};
use results::report::error_text;
use results::run_record::{HashedFile, Parameter};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

const TICKS: u64 = 15;

fn identity() -> Identity {
    let file = |name: &str| HashedFile { name: name.to_owned(), sha256: "0123456789abcdef".repeat(4) };
    let parameter = |name: &str, value: &str| Parameter { name: name.to_owned(), value: value.to_owned(), set: false };
    Identity {
        script: "fedcba9876543210".repeat(4),
        step_ns: 5_000_000,
        parameters: vec![parameter("mean", "3 m/s"), parameter("seed", "1")],
        case: None,
        units: vec![file("wind"), file("quadcopter")],
        files: vec![file("yard.csv")],
    }
}

/// The fuzz target: any bytes as a checkpoint of the run of `everything`.
fn read(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let script = everything(TICKS);
    let identity = identity();
    let checkpoint = identity.checkpoint_in(bytes)?;
    Checkpoint::read(checkpoint, &script.scenario, &vec![&description(); script.units.len()])
}

/// The content of a checkpoint of `everything`, without the file around it.
fn saved() -> &'static [u8] {
    static SAVED: OnceLock<Vec<u8>> = OnceLock::new();
    SAVED.get_or_init(|| {
        let ran = everything(TICKS).saving([7]).run();
        postcard::to_stdvec(&ran.checkpoints[0]).unwrap()
    })
}

fn file(checkpoint: &[u8]) -> Vec<u8> {
    identity().file_around(checkpoint).unwrap()
}

#[test]
fn a_checkpoint_comes_back_as_it_was_saved() {
    let checkpoint = read(&file(saved())).unwrap();
    assert_eq!(checkpoint.tick, 7);
    assert_eq!(postcard::to_stdvec(&checkpoint).unwrap(), saved());
}

#[test]
fn the_origin_of_a_parameter_makes_no_difference_if_its_value_is_the_same() {
    let mut set = identity();
    set.parameters[0].set = true;
    assert!(read(&set.file_around(saved()).unwrap()).is_ok());
}

#[test]
fn all_differences_are_reported_at_once_with_help() {
    let error_for = |change: &dyn Fn(&mut Identity)| {
        let mut other = identity();
        change(&mut other);
        let error = read(&other.file_around(saved()).unwrap()).unwrap_err();
        error_text(&error, Some(&error.help())) + "\n"
    };
    let whole = file(saved());
    let refused = |bytes: &[u8]| {
        let error = read(bytes).unwrap_err();
        error_text(&error, Some(&error.help())) + "\n"
    };
    let version = |version: &str| {
        let content = postcard::to_stdvec(&(version, identity())).unwrap();
        let length = (content.len() as u64).to_le_bytes();
        [MAGIC, &FORMAT.to_le_bytes()[..], &length, &Sha256::digest(&content), &content].concat()
    };
    let end = postcard::to_stdvec(&everything(40).saving([15]).run().checkpoints[0]).unwrap();
    let texts = [
        error_for(&|other| other.parameters[0].value = "25 m/s".to_owned()),
        error_for(&|other| other.parameters.truncate(1)),
        error_for(&|other| other.script = "0".repeat(64)),
        error_for(&|other| {
            other.step_ns = 10_000_000;
            other.units[1].sha256 = "1".repeat(64);
            other.files.clear();
            other.parameters[1].value = "2".to_owned();
        }),
        error_for(&|other| other.units[0].name = "\x1b[2J".to_owned()),
        refused(b"time,quad.x\n"),
        refused(&[MAGIC.as_slice(), &(FORMAT - 1).to_le_bytes()].concat()),
        refused(&whole[..whole.len() - 1]),
        refused(&version("0.0.9")),
        refused(&file(&end)),
        refused(&file(&[saved(), b"more"].concat())),
    ];
    insta::assert_snapshot!(texts.concat());
}

/// Writes the kept files anew in the present format: those that derive from a whole checkpoint, and the format number of
/// the others.
fn remake(folder: &Path) {
    let cut = &saved()[..saved().len() - 5];
    let more = [saved(), &[0]].concat();
    let (mut other_tick, mut nothing) = (saved().to_vec(), vec![0; 20]);
    (other_tick[0], nothing[0]) = (8, 7);
    let parts = [
        ("accepted-amid-everything", saved()),
        ("damaged-cut-off", cut),
        ("unfit-one-byte-more", &more),
        ("unfit-other-tick", &other_tick),
        ("unfit-nothing-in-it", &nothing),
    ];
    for (name, bytes) in parts {
        fs::write(folder.join(format!("{name}.part")), bytes).unwrap();
    }
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let mut bytes = fs::read(&path).unwrap();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let format = match name {
            "format-of-yesterday" => FORMAT - 1,
            "format-of-tomorrow" => FORMAT + 1,
            _ => FORMAT,
        };
        if bytes.starts_with(MAGIC) && bytes.len() >= MAGIC.len() + 4 {
            bytes[MAGIC.len()..][..4].copy_from_slice(&format.to_le_bytes());
            fs::write(path, bytes).unwrap();
        }
    }
}

/// `FILE.whole` is a file, `FILE.part` what follows its identity; its first word is the expected result.
/// After a change of the format `LOCKSTEP_UPDATE=1 cargo test -p orchestrator --test step_loop kept_file` writes them anew.
#[test]
fn every_kept_file_is_judged_as_its_name_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/checkpoints");
    if std::env::var_os("LOCKSTEP_UPDATE").is_some() {
        remake(&folder);
    }
    let mut judged = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        let judgement = match read(&if path.extension().is_some_and(|e| e == "part") { file(&bytes) } else { bytes }) {
            Ok(_) => "accepted",
            Err(CheckpointError::NoCheckpoint) => "none",
            Err(CheckpointError::Format(_)) => "format",
            Err(CheckpointError::Damaged) => "damaged",
            Err(CheckpointError::Unfit) => "unfit",
            Err(other) => panic!("{}: {other}", path.display()),
        };
        let name = path.file_name().unwrap().to_str().unwrap();
        assert_eq!(name.split('-').next(), Some(judgement), "{name}");
        judged += 1;
    }
    assert!(judged >= 8, "the kept files are there");
}

fn changed(bytes: &[u8], changes: &[(usize, u8)], cut: Option<usize>) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    let length = changed.len();
    changes.iter().for_each(|&(at, value)| changed[at % length] = value);
    changed.truncate(cut.map_or(length, |cut| cut % length));
    changed
}

fn any_changes() -> impl Strategy<Value = Vec<(usize, u8)>> {
    prop::collection::vec((0_usize..1 << 16, any::<u8>()), 0..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(read(&bytes).is_err());
        prop_assert!(read(&file(&bytes)).is_err());
    }

    #[test]
    fn any_change_of_a_file_is_found(changes in any_changes(), cut in prop::option::of(0_usize..1 << 16)) {
        let whole = file(saved());
        let other = changed(&whole, &changes, cut);
        prop_assert_eq!(read(&other).is_ok(), other == whole);
    }

    #[test]
    fn a_changed_checkpoint_with_a_valid_hash_runs_without_a_panic(
        changes in any_changes(), cut in prop::option::weighted(0.1, 0_usize..1 << 16),
    ) {
        if let Ok(checkpoint) = read(&file(&changed(saved(), &changes, cut))) {
            let ran = everything(TICKS).from(&checkpoint).run();
            prop_assert!(ran.result.is_err() || ran.standings.len() == 4);
        }
    }
}
