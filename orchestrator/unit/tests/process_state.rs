//! A unit that changes the state of its process while it is instantiated.
//!
//! This test has a process of its own, because the working directory is shared by all threads.
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use std::env::current_dir;
use std::hint::black_box;
use std::sync::Arc;
use tests::foreign::Foreign;
use unit::archive::unpack;
use unit::board::{Board, BoardLayout};
use unit::instance::{Instance, Setting};
use unit::library::Library;

#[test]
fn a_rounding_mode_and_a_folder_changed_by_instantiate_are_restored() {
    let before = current_dir().unwrap();
    assert_ne!(before.as_os_str(), "/");
    let (folder, fmu) = Foreign { defines: &["DISTURB"], ..Foreign::default() }.build();
    let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let note = Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap().note(0);
    let library = Arc::new(Library::load(&unpacked.folder, &unpacked.description, &note, 0).unwrap());
    let setting = Setting { name: "unit", index: 0, note, sink: Arc::new(|_| ()), logging_on: false, calls: None };
    let _instance = Instance::instantiate(&library, setting).unwrap();
    assert_eq!(current_dir().unwrap(), before);
    // In the rounding mode that the unit sets, downward, the result would be further from zero.
    assert_eq!(black_box(1.0_f64) / black_box(-3.0), -0.333_333_333_333_333_3);
}
