//! A panic of a unit stays on its side of the border.

use crate::importer::{ERROR, Importer, OK};
use crate::probe::{UNLUCKY_M_S, port};

fn panicked() -> Importer {
    let importer = Importer::new().started();
    assert_eq!((importer.set_integer(port::DEED, 6), importer.set_real(port::SPEED, UNLUCKY_M_S)), (OK, OK));
    assert_eq!(importer.step(0.0, 0.1), ERROR);
    assert_eq!(importer.said(), "fmi2DoStep: the unit panicked, which is a defect of it: told to panic");
    importer
}

#[test]
fn after_a_panic_values_can_be_read_and_nothing_else() {
    let importer = panicked();
    assert_eq!(importer.real(port::SPEED), UNLUCKY_M_S);
    assert_eq!((importer.set_real(port::SPEED, 2.0), importer.step(0.1, 0.1)), (ERROR, ERROR));
    let texts: Vec<_> = importer.messages().into_iter().map(|message| message.text).collect();
    assert_eq!(
        texts,
        ["fmi2SetReal", "fmi2DoStep"]
            .map(|call| format!("{call}: the unit panicked before; it can be read, reset and freed"))
    );
}

#[test]
fn a_reset_makes_a_panicked_instance_anew() {
    let importer = panicked();
    assert_eq!(importer.reset(), OK);
    let importer = importer.started();
    assert_eq!((importer.step(0.0, 0.1), importer.integer(port::DEED)), (OK, 1));
}

#[test]
fn a_panic_in_one_instance_leaves_others_alone() {
    let other = Importer::new().started();
    let _panicked = panicked();
    assert_eq!(other.step(0.0, 0.1), OK);
}
