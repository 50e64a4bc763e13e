//! Unit `trajectory`: the ports of `models::trajectory`.
#![forbid(unsafe_code)]

use fmu::{Context, Fault, Fmu, Model, Outcome, Step, vehicle};
use models::trajectory::Parameters;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A flight from take-off at A over straights and two half circles to landing at H.
#[derive(Fmu, Clone, Serialize, Deserialize)]
#[fmu(experiment(stop = 84.0, step = 0.01))]
struct Trajectory {
    /// What a vehicle should do now
    #[output(depends(), init(depends(height, speed, radius1, radius2, origin)))]
    setpoint: vehicle::Setpoint,
    /// The part of the flight, from 1 (A to B) to 7 (G to H)
    #[output(depends(), init(depends(speed, radius1, radius2)))]
    leg: i32,
    /// Whether the whole flight is over
    #[output(depends(), init(depends(speed, radius1, radius2)))]
    finished: bool,

    /// Height of the flight above its origin
    #[parameter(start = Parameters::default().height_m, unit = "m")]
    height: f64,
    /// Speed on the circles and on the straight between them
    #[parameter(start = Parameters::default().speed_m_s, unit = "m/s", min = 0.1)]
    speed: f64,
    /// Radius of the first half circle, to the right
    #[parameter(start = Parameters::default().radius1_m, unit = "m", min = 0.1)]
    radius1: f64,
    /// Radius of the second half circle, to the left
    #[parameter(start = Parameters::default().radius2_m, unit = "m", min = 0.1)]
    radius2: f64,
    /// Point A, world frame
    #[parameter(start = [0.0; 3], unit = "m")]
    origin: Vector3<f64>,
}

impl Trajectory {
    fn show(&mut self, time_s: f64) {
        let parameters = Parameters {
            height_m: self.height,
            speed_m_s: self.speed,
            radius1_m: self.radius1,
            radius2_m: self.radius2,
            origin_m: self.origin,
        };
        let reference = parameters.reference(time_s);
        self.setpoint = vehicle::Setpoint {
            position: reference.setpoint.position_m,
            velocity: reference.setpoint.velocity_m_s,
            acceleration: reference.setpoint.acceleration_m_s2,
            yaw: reference.setpoint.yaw_rad,
        };
        self.leg = reference.leg;
        self.finished = reference.finished;
    }
}

impl Model for Trajectory {
    fn init(&mut self, context: &mut Context) -> Result<(), Fault> {
        self.show(context.start_s());
        Ok(())
    }

    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault> {
        let (leg, finished) = (self.leg, self.finished);
        self.show(step.end_s());
        if self.leg != leg {
            context.event(|| format!("leg {} begins at {} s", self.leg, step.end_s()));
        }
        if self.finished && !finished {
            context.event(|| format!("the flight is over at {} s", step.end_s()));
        }
        Ok(Outcome::Done)
    }
}

fmu::export!(Trajectory);
