//! What several claims and connections use under one name.

use super::fixtures::{flight, scenario};
use dsl::scenario::{Drive, Formula, Margin, RealExpression as E, Scenario};

const FAR: &str = "norm(quad.state.position)";

/// Three claims and two connections that use a name.
fn uses(name: &str) -> Scenario {
    let claims = "assert a: always FAR < 30 m\nassert b: always FAR < 40 m\nassert c: eventually FAR > 3 m\n";
    let wires = "FAR -> ctrl.setpoint.x\nFAR * 2 => ctrl.setpoint.y\n";
    scenario(&flight(&format!("let far = {FAR}\n{}", format!("{claims}{wires}").replace("FAR", name))))
}

#[test]
fn a_value_that_claims_and_connections_use_has_one_slot() {
    let scenario = uses("far");
    assert!(matches!(scenario.shared.as_slice(), [E::Call(..)]), "{:?}", scenario.shared);
    assert_eq!(scenario.connections[0].source, Drive::Real(E::Shared(0)));
    let twice = E::Multiply(Box::new(E::Shared(0)), Box::new(E::Constant(2.0)));
    assert_eq!(scenario.connections[1].source, Drive::Real(twice));
    let value = E::Subtract(Box::new(E::Constant(30.0)), Box::new(E::Shared(0)));
    let Formula::Always(_, body) = &scenario.claims[0].formula else { panic!("{:?}", scenario.claims[0]) };
    assert_eq!(**body, Formula::Margin(Margin { value, strict: true }));
}

#[test]
fn a_connection_reads_what_a_slot_reads() {
    let scenario = uses("far");
    let mut ports = Vec::new();
    scenario.connections[0].source.reads(scenario.slots(), &mut |port| ports.push(port.variable));
    assert_eq!(ports, [12, 13, 14]);
}

#[test]
fn what_is_used_once_or_read_alone_has_no_slot() {
    let lines = "let once = quad.roll * 2\nlet plain = quad.height\nlet fixed = 3 m * 2\n\
                 assert a: always once < 1 rad\nassert b: always plain < fixed\nassert c: always plain < fixed * 2";
    assert_eq!(scenario(&flight(lines)).shared, []);
}

#[test]
fn a_slot_may_use_those_before_it_and_elements_have_their_own() {
    let lines = "let both = [quad.roll * 2, quad.roll * 3]\nlet sum = both[1] + both[2]\n\
                 assert a: always sum < 1 rad\nassert b: always sum < 2 rad\nassert c: always both[2] < 1 rad";
    let shared = scenario(&flight(lines)).shared;
    let [E::Multiply(_, three), E::Add(first, second)] = shared.as_slice() else { panic!("{shared:?}") };
    assert_eq!((&**three, &**second), (&E::Constant(3.0), &E::Shared(0)));
    assert!(matches!(**first, E::Multiply(..)), "{first:?}");
}
