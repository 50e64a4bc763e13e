//! Saved states: in memory, as bytes, and invalid ones.

use crate::importer::{DISCARD, ERROR, Importer, OK};
use crate::probe::{library, port};
use fmu::testing::{read_foreign_state, written_state};
use std::ffi::c_void;
use std::ptr::{dangling_mut, null_mut};

/// A state of another instance, as bytes.
pub fn written_by_another() -> Vec<u8> {
    let other = Importer::new().started();
    other.written(other.saved())
}

/// Makes steps of 0.1 s with these numbers; returns the bits of the position after each.
fn run(importer: &Importer, steps: std::ops::Range<u32>) -> Vec<u64> {
    let one = |n| {
        assert_eq!(importer.step(f64::from(n) * 0.1, 0.1), OK);
        importer.real(port::POSITION_X).to_bits()
    };
    steps.map(one).collect()
}

#[test]
fn a_restored_instance_continues_with_the_same_bits() {
    let importer = Importer::new().started();
    run(&importer, 0..3);
    let saved = importer.saved();
    let first = run(&importer, 3..9);
    assert_eq!(importer.restore(saved), OK);
    assert_eq!(run(&importer, 3..9), first);
}

#[test]
fn another_instance_reads_a_serialized_state_and_continues() {
    let importer = Importer::new().started();
    run(&importer, 0..3);
    let bytes = importer.written(importer.saved());
    let first = run(&importer, 3..9);
    let (other, mut handle) = (Importer::new(), null_mut());
    assert_eq!((other.read(&bytes, &mut handle), other.restore(handle)), (OK, OK));
    assert_eq!(run(&other, 3..9), first);
}

#[test]
fn a_serialized_state_is_read_into_a_reused_handle() {
    let importer = Importer::new().started();
    let bytes = importer.written(importer.saved());
    run(&importer, 0..2);
    let later = importer.saved();
    let mut handle = later;
    assert_eq!((importer.read(&bytes, &mut handle), handle), (OK, later));
    assert_eq!((importer.restore(handle), importer.real(port::POSITION_X)), (OK, 0.0));
}

#[test]
fn a_discarded_step_is_repeated_from_a_saved_state() {
    let importer = Importer::new().started();
    let saved = importer.saved();
    assert_eq!(importer.set_integer(port::DEED, 3), OK);
    assert_eq!(importer.step(0.0, 0.1), DISCARD);
    assert_eq!((importer.restore(saved), importer.step(0.0, 0.05)), (OK, OK));
    assert_eq!(importer.real(port::STEP_LENGTH), 0.05);
}

#[test]
fn a_handle_is_reused() {
    let importer = Importer::new().started();
    let first = importer.saved();
    run(&importer, 0..2);
    let mut again = first;
    assert_eq!((importer.save(&mut again), again), (OK, first));
    run(&importer, 2..4);
    assert_eq!(importer.restore(again), OK);
    assert_eq!(importer.real(port::POSITION_X), 0.2, "the later of the two saved states");
}

#[test]
fn a_freed_handle_becomes_null_and_nothing_is_freed_twice() {
    let importer = Importer::new().started();
    let kept = importer.saved();
    let mut freed = importer.saved();
    let stale = freed;
    assert_eq!((importer.free_state(&mut freed), freed), (OK, null_mut()));
    assert_eq!(importer.free_state(&mut freed), OK, "there is nothing to free");
    assert_eq!(importer.restore(kept), OK);
    assert_eq!(importer.restore(stale), ERROR);
    assert!(importer.only_message().contains("not of a state that this instance saved"));
}

#[test]
fn handles_of_other_instances_and_unknown_handles_are_refused() {
    let (importer, other) = (Importer::new().started(), Importer::new().started());
    for mut handle in [other.saved(), dangling_mut::<c_void>(), null_mut()] {
        assert_eq!(importer.restore(handle), ERROR);
        assert_eq!(importer.reset(), OK);
        if !handle.is_null() {
            assert_eq!((importer.save(&mut handle), importer.reset()), (ERROR, OK));
            assert_eq!((importer.free_state(&mut handle), importer.reset()), (ERROR, OK));
        }
    }
    assert_eq!(other.step(0.0, 0.1), OK);
}

#[test]
fn a_damaged_byte_is_refused_at_every_position() {
    let importer = Importer::new().started();
    let bytes = importer.written(importer.saved());
    let refused = |bytes: &[u8]| {
        let mut handle = null_mut();
        assert_eq!((importer.read(bytes, &mut handle), handle), (ERROR, null_mut()), "{bytes:?}");
        assert!(importer.only_message().contains("are not a state of this unit"));
        assert_eq!(importer.reset(), OK);
    };
    for length in 0..bytes.len() {
        refused(&bytes[..length]);
    }
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x55;
        refused(&damaged);
    }
    refused(&[&*bytes, &[0]].concat());
    let (mut handle, good) = (null_mut(), importer.read(&bytes, &mut null_mut()));
    assert_eq!((good, importer.read(&bytes, &mut handle)), (OK, OK));
}

#[test]
fn a_reset_instance_equals_a_new_one() {
    let importer = Importer::new();
    let fresh = importer.written(importer.saved());
    let importer = importer.started();
    assert_eq!(importer.set_real(port::SPEED, 7.0), OK);
    run(&importer, 0..3);
    assert_eq!(importer.reset(), OK);
    assert_eq!(importer.written(importer.saved()), fresh);
}

#[test]
fn no_bytes_cause_a_panic_of_the_reader_of_states() {
    let good = written_state(library()).expect("it can be written");
    // Generated by a fixed rule, so that a failure is reproducible: xorshift of Marsaglia (2003).
    let mut random = 0x9e37_79b9_u32;
    let mut next = || {
        random ^= random << 13;
        random ^= random >> 17;
        random ^= random << 5;
        random as usize
    };
    for _ in 0..20_000 {
        let mut bytes = good.clone();
        for _ in 0..1 + next() % 4 {
            let place = next() % bytes.len();
            bytes[place] = next() as u8;
        }
        bytes.truncate(next() % (2 * good.len()));
        read_foreign_state(library(), &bytes);
    }
}
