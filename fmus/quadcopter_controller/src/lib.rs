//! Unit `quadcopter_controller`: the ports of `models::quadcopter_controller`.
#![forbid(unsafe_code)]

use fmu::{Context, Fault, FmiEnum, Fmu, Model, Outcome, Step, vehicle};
use models::quadcopter_controller::{Mode, Parameters, State};
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

mod gains;

use gains::Gains;

/// The airframe and limits of the parameters' start values.
fn airframe() -> Parameters {
    Parameters::default()
}

/// Flies a quadcopter to its setpoint: PID position and altitude loops over a backstepping attitude law.
#[derive(Fmu, Clone, Serialize, Deserialize)]
#[fmu(experiment(stop = 5.0, step = 0.005))]
struct QuadcopterController {
    /// State of the vehicle
    #[input]
    state: vehicle::State,
    /// What the vehicle should do
    #[input]
    setpoint: vehicle::Setpoint,
    /// Whether the vehicle stands on the ground; mode q2 does not ask
    #[input(start = false)]
    contact: bool,
    /// Speed of the wind; mode q2 does not ask
    #[input(start = 0.0, unit = "m/s", min = 0.0)]
    wind_speed: f64,
    /// What is left of each rotor's thrust: 1 healthy, 0 lost; mode q2 does not ask
    #[input(start = [1.0; 4], unit = "1", min = 0.0, max = 1.0)]
    effectiveness: [f64; 4],

    /// Speed for the rotors right, front, left, rear; 0 until the first sample
    #[output(unit = "rad/s", display = "rpm", depends())]
    rotor_speed: [f64; 4],
    /// Roll that turns the thrust into the demanded force
    #[output(unit = "rad", display = "deg", depends())]
    roll_desired: f64,
    /// Pitch that does, nose down
    #[output(unit = "rad", display = "deg", depends())]
    pitch_desired: f64,
    /// Demanded sum of thrusts
    #[output(unit = "N", depends())]
    thrust_desired: f64,

    /// Gains for take-off and landing
    #[parameter(start = Gains::of(Mode::Q1))]
    q1: Gains,
    /// Gains for calm air and light wind
    #[parameter(start = Gains::of(Mode::Q2))]
    q2: Gains,
    /// Gains for moderate wind
    #[parameter(start = Gains::of(Mode::Q3))]
    q3: Gains,
    /// Gains for emergency termination
    #[parameter(start = Gains::of(Mode::Q4))]
    q4: Gains,
    /// Largest angle between the demanded force and the vertical
    #[parameter(start = airframe().tilt_max_rad, unit = "rad", display = "deg", min = 0.0, max = 1.5)]
    tilt_max: f64,
    /// Mass of the vehicle
    #[parameter(start = airframe().mass_kg, unit = "kg", min = 1e-6)]
    mass: f64,
    /// Principal moments of inertia of the vehicle, body frame
    #[parameter(start = airframe().inertia_kg_m2.into(), unit = "kg*m^2", min = 1e-9)]
    inertia: Vector3<f64>,
    /// From the vehicle's centre of gravity to each rotor axis
    #[parameter(start = airframe().arm_m, unit = "m", min = 1e-3)]
    arm: f64,
    /// Thrust of a rotor divided by the square of its speed
    #[parameter(start = airframe().thrust_coefficient_n_s2, unit = "N*s^2", min = 1e-12)]
    thrust_coefficient: f64,
    /// Drag torque of a rotor divided by the square of its speed
    #[parameter(start = airframe().torque_coefficient_n_m_s2, unit = "N*m*s^2", min = 1e-15)]
    torque_coefficient: f64,
    /// Least speed commanded to a rotor
    #[parameter(start = airframe().rotor_speed_min_rad_s, unit = "rad/s", display = "rpm", min = 0.0)]
    rotor_speed_min: f64,
    /// Greatest speed commanded to a rotor
    #[parameter(start = airframe().rotor_speed_max_rad_s, unit = "rad/s", display = "rpm", min = 0.0)]
    rotor_speed_max: f64,
    /// Acceleration of gravity
    #[parameter(start = airframe().gravity_m_s2, unit = "m/s^2", min = 0.0)]
    gravity: f64,
    /// The paper's attitude law as it is meant, or as it is printed
    #[parameter(start = FormulaSet::Corrected)]
    formula_set: FormulaSet,

    memory: State,
}

/// The paper's attitude law as it is meant, or as it is printed
#[derive(FmiEnum, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum FormulaSet {
    /// Signs and couplings derived anew
    Corrected,
    /// Signs and couplings as printed: does not fly
    Printed,
}

impl QuadcopterController {
    fn parameters(&self) -> Parameters {
        Parameters {
            mass_kg: self.mass,
            gravity_m_s2: self.gravity,
            inertia_kg_m2: self.inertia,
            arm_m: self.arm,
            thrust_coefficient_n_s2: self.thrust_coefficient,
            torque_coefficient_n_m_s2: self.torque_coefficient,
            rotor_speed_min_rad_s: self.rotor_speed_min,
            rotor_speed_max_rad_s: self.rotor_speed_max,
            tilt_max_rad: self.tilt_max,
            formula_set: match self.formula_set {
                FormulaSet::Corrected => models::quadcopter_controller::FormulaSet::Corrected,
                FormulaSet::Printed => models::quadcopter_controller::FormulaSet::Printed,
            },
        }
    }
}

impl Model for QuadcopterController {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        self.memory = State::default();
        self.rotor_speed = [0.0; 4];
        (self.roll_desired, self.pitch_desired, self.thrust_desired) = (0.0, 0.0, 0.0);
        Ok(())
    }

    fn step(&mut self, step: Step, _: &mut Context) -> Result<Outcome, Fault> {
        let vehicle = models::vehicle::State {
            position_m: self.state.position,
            attitude: UnitQuaternion::new_normalize(self.state.attitude),
            velocity_world_m_s: self.state.velocity,
            rate_body_rad_s: self.state.rate,
        };
        let setpoint = models::vehicle::Setpoint {
            position_m: self.setpoint.position,
            velocity_m_s: self.setpoint.velocity,
            acceleration_m_s2: self.setpoint.acceleration,
            yaw_rad: self.setpoint.yaw,
        };
        let gains = self.q2.into();
        let command = self.memory.sample(&self.parameters(), &gains, &vehicle, &setpoint, step.length_s());
        self.rotor_speed = command.rotor_speed_rad_s;
        self.roll_desired = command.roll_rad;
        self.pitch_desired = command.pitch_rad;
        self.thrust_desired = command.thrust_n;
        Ok(Outcome::Done)
    }
}

fmu::export!(QuadcopterController);
