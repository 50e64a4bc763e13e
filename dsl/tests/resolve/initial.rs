//! The order of initialization.

use super::fixtures::{flight, scenario};
use dsl::scenario::InitialStep;

#[test]
fn a_start_value_on_the_circle_breaks_it_and_every_driven_input_is_set() {
    let line = "fmu loop = \"quadcopter_controller\" { unset = 0 m, stream = 1, setpoint = [1, 2] m }
loop.rotor_speed[1] in rad/s * 1 m -> loop.setpoint.x";
    let scenario = scenario(&flight(line));
    assert_eq!(
        scenario.initialization,
        [InitialStep::Get { instance: 3, variables: vec![18] }, InitialStep::Set { instance: 3, connections: vec![0] },]
    );
}

#[test]
fn what_depends_on_a_broken_circle_from_outside_waits_for_the_driver() {
    let line = "fmu loop = \"quadcopter_controller\" { unset = 0 m, stream = 1, setpoint = [1, 2] m }
loop.rotor_speed[1] in rad/s * 1 m -> loop.setpoint.x
loop.rotor_speed[2] -> quad.rotor_speed[2]";
    let scenario = scenario(&flight(line));
    assert_eq!(
        scenario.initialization,
        [
            InitialStep::Get { instance: 3, variables: vec![18] },
            InitialStep::Set { instance: 3, connections: vec![1] },
            InitialStep::Get { instance: 3, variables: vec![19] },
            InitialStep::Set { instance: 1, connections: vec![0] },
        ]
    );
}

#[test]
fn a_start_value_off_the_circle_leaves_the_order_alone() {
    let line = "fmu next = \"quadcopter_controller\" { unset = 0 m, stream = 1, state.position.z = 4 m }
quad.state -> next.state
next.thrust * 0.2 m -> quad.moment";
    let scenario = scenario(&flight(line));
    assert_eq!(
        scenario.initialization,
        [
            InitialStep::Get { instance: 1, variables: vec![12, 13, 14] },
            InitialStep::Set { instance: 3, connections: vec![1, 2, 3] },
            InitialStep::Get { instance: 3, variables: vec![20] },
            InitialStep::Set { instance: 1, connections: vec![0] },
        ]
    );
}

#[test]
fn inputs_of_one_instance_are_set_together_once_all_are_known() {
    let lines = "wind.velocity.x * 1 s -> ctrl.setpoint.x\nquad.height -> ctrl.setpoint.y\nquad.landed -> ctrl.armed";
    let scenario = scenario(&flight(lines));
    assert_eq!(
        scenario.initialization,
        [
            InitialStep::Get { instance: 0, variables: vec![5] },
            InitialStep::Get { instance: 1, variables: vec![17, 18] },
            InitialStep::Set { instance: 2, connections: vec![0, 1, 2] },
        ]
    );
}
