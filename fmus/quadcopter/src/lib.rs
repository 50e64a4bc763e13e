//! Unit `quadcopter`: the ports of `models::quadcopter`.
#![forbid(unsafe_code)]

use fmu::{Context, Fault, FmiEnum, Fmu, Model, Outcome, Step, vehicle};
use models::quadcopter::{GroundTurbulence, INNER_STEP_S, Inputs, Parameters, State};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The airframe of the parameters' start values.
fn airframe() -> Parameters {
    Parameters::default()
}

/// Quadcopter in wind: rigid body, four rotors with lag, ground effect, drag and ground contact.
#[derive(Fmu, Clone, Serialize, Deserialize)]
#[fmu(experiment(stop = 10.0, step = 0.005))]
struct Quadcopter {
    /// Commanded speed of the rotors right, front, left, rear
    #[input(start = [0.0; 4], unit = "rad/s", display = "rpm", min = 0.0)]
    rotor_speed: [f64; 4],
    /// Velocity of the air over the ground, world frame
    #[input(start = [0.0; 3], unit = "m/s")]
    wind: Vector3<f64>,
    /// What is left of each rotor's thrust and drag torque: 1 healthy, 0 lost
    #[input(start = [1.0; 4], unit = "1", min = 0.0, max = 1.0)]
    effectiveness: [f64; 4],

    /// State of the body
    #[output(depends(), init(depends(position0, velocity0, yaw0)))]
    state: vehicle::State,
    /// Roll, left side up
    #[output(unit = "rad", display = "deg", depends())]
    roll: f64,
    /// Pitch, nose down
    #[output(unit = "rad", display = "deg", depends(), init(depends(yaw0)))]
    pitch: f64,
    /// Yaw, counter-clockwise from east
    #[output(unit = "rad", display = "deg", depends(), init(depends(yaw0)))]
    yaw: f64,
    /// Rotors as they turn
    #[output(depends(), init(depends(airborne, mass, gravity, thrust_coefficient, rotor_speed_min)))]
    rotor: Rotor,
    /// Sum of the rotors' thrusts
    #[output(
        unit = "N",
        depends(wind, effectiveness),
        init(depends(
            wind,
            effectiveness,
            position0,
            velocity0,
            yaw0,
            airborne,
            mass,
            gravity,
            thrust_coefficient,
            rotor_speed_min,
            rotor_radius,
            rotor_solidity,
            lift_slope,
            hub_height,
            air_density,
            rotor_model,
            ground_effect,
            ground_turbulence,
            sample_time,
            seed,
            stream,
        ))
    )]
    thrust: f64,
    /// Height of the centre of gravity above the ground
    #[output(unit = "m", depends(), init(depends(position0)))]
    height: f64,
    /// Whether the vehicle stands on the ground
    #[output(depends(), init(depends(position0)))]
    contact: bool,

    /// Position at the start, world frame
    #[parameter(start = [0.0; 3], unit = "m")]
    position0: Vector3<f64>,
    /// Velocity at the start, world frame
    #[parameter(start = [0.0; 3], unit = "m/s")]
    velocity0: Vector3<f64>,
    /// Heading at the start, counter-clockwise from east
    #[parameter(start = 0.0, unit = "rad", display = "deg")]
    yaw0: f64,
    /// Whether the rotors start at hover speed
    #[parameter(start = false)]
    airborne: bool,
    /// Mass
    #[parameter(start = airframe().mass_kg, unit = "kg", min = 1e-6)]
    mass: f64,
    /// From the centre of gravity to each rotor axis
    #[parameter(start = airframe().arm_m, unit = "m", min = 0.0)]
    arm: f64,
    /// Height of the rotor hubs above the centre of gravity
    #[parameter(start = airframe().hub_height_m, unit = "m")]
    hub_height: f64,
    /// Principal moments of inertia, body frame
    #[parameter(start = airframe().inertia_kg_m2.into(), unit = "kg*m^2", min = 1e-9)]
    inertia: Vector3<f64>,
    /// Static thrust of a rotor divided by the square of its speed
    #[parameter(start = airframe().thrust_coefficient_n_s2, unit = "N*s^2", min = 1e-12)]
    thrust_coefficient: f64,
    /// Drag torque of a rotor divided by the square of its speed
    #[parameter(start = airframe().torque_coefficient_n_m_s2, unit = "N*m*s^2", min = 0.0)]
    torque_coefficient: f64,
    /// Moment of inertia of a rotor with its motor
    #[parameter(start = airframe().rotor_inertia_kg_m2, unit = "kg*m^2", min = 0.0)]
    rotor_inertia: f64,
    /// Radius of a rotor
    #[parameter(start = airframe().rotor_radius_m, unit = "m", min = 1e-3)]
    rotor_radius: f64,
    /// Blade area of a rotor divided by the area of its disc
    #[parameter(start = airframe().rotor_solidity, unit = "1", min = 1e-3)]
    rotor_solidity: f64,
    /// Slope of the blades' lift coefficient over the angle of attack
    #[parameter(start = airframe().lift_slope_per_rad, unit = "1/rad", min = 1e-3)]
    lift_slope: f64,
    /// Time constant of the motors
    #[parameter(start = airframe().motor_time_constant_s, unit = "s", min = 1e-3)]
    motor_time_constant: f64,
    /// Least speed that a rotor can be commanded to
    #[parameter(start = airframe().rotor_speed_min_rad_s, unit = "rad/s", display = "rpm", min = 0.0)]
    rotor_speed_min: f64,
    /// Greatest speed that a rotor can be commanded to
    #[parameter(start = airframe().rotor_speed_max_rad_s, unit = "rad/s", display = "rpm", min = 0.0)]
    rotor_speed_max: f64,
    /// Density of the air
    #[parameter(start = airframe().air_density_kg_m3, unit = "kg/m^3", min = 1e-6)]
    air_density: f64,
    /// Acceleration of gravity
    #[parameter(start = airframe().gravity_m_s2, unit = "m/s^2", min = 0.0)]
    gravity: f64,
    /// Area of the body that meets the wind from any side
    #[parameter(start = airframe().body_area_m2, unit = "m^2", min = 0.0)]
    body_area: f64,
    /// Part of a rotor's disc that acts as area in the wind
    #[parameter(start = airframe().disc_area_fraction, unit = "1", min = 0.0)]
    disc_area_fraction: f64,
    /// Drag coefficient
    #[parameter(start = airframe().drag_coefficient, unit = "1", min = 0.0)]
    drag_coefficient: f64,
    /// How thrust depends on the air that meets a rotor
    #[parameter(start = RotorModel::Bemt)]
    rotor_model: RotorModel,
    /// Whether the ground strengthens the thrust of rotors near to it
    #[parameter(start = airframe().ground_effect)]
    ground_effect: bool,
    /// Standard deviation of the thrust's trembling at the ground, as a part of the thrust
    #[parameter(start = airframe().ground_turbulence, unit = "1", min = 0.0)]
    ground_turbulence: f64,
    /// How long a sample of the trembling holds
    #[parameter(start = airframe().ground_turbulence_sample_time_s, unit = "s", min = 1e-4)]
    sample_time: f64,
    /// Seed of the trembling
    #[parameter(start = 1, min = 0)]
    seed: i32,
    /// Stream of random numbers, apart from those of other units with this seed
    #[parameter(start = 4, min = 0)]
    stream: i32,

    plant: State,
    turbulence: GroundTurbulence,
}

/// Rotors as they turn
#[derive(fmu::Group, Clone, Serialize, Deserialize)]
struct Rotor {
    /// Speed of the rotors right, front, left, rear
    #[port(unit = "rad/s", display = "rpm")]
    speed: [f64; 4],
}

/// How a rotor's thrust depends on the air that meets it
#[derive(FmiEnum, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum RotorModel {
    /// Blade element and momentum theory together
    Bemt,
    /// The formula as the paper prints it
    Paper,
    /// Proportional to the square of the rotor's speed, whatever the air does
    Kw2,
}

impl Quadcopter {
    fn parameters(&self) -> Parameters {
        Parameters {
            mass_kg: self.mass,
            arm_m: self.arm,
            hub_height_m: self.hub_height,
            inertia_kg_m2: self.inertia,
            thrust_coefficient_n_s2: self.thrust_coefficient,
            torque_coefficient_n_m_s2: self.torque_coefficient,
            rotor_inertia_kg_m2: self.rotor_inertia,
            rotor_radius_m: self.rotor_radius,
            rotor_solidity: self.rotor_solidity,
            lift_slope_per_rad: self.lift_slope,
            motor_time_constant_s: self.motor_time_constant,
            rotor_speed_min_rad_s: self.rotor_speed_min,
            rotor_speed_max_rad_s: self.rotor_speed_max,
            air_density_kg_m3: self.air_density,
            gravity_m_s2: self.gravity,
            body_area_m2: self.body_area,
            disc_area_fraction: self.disc_area_fraction,
            drag_coefficient: self.drag_coefficient,
            rotor_model: match self.rotor_model {
                RotorModel::Bemt => models::quadcopter::RotorModel::Bemt,
                RotorModel::Paper => models::quadcopter::RotorModel::Paper,
                RotorModel::Kw2 => models::quadcopter::RotorModel::Kw2,
            },
            ground_effect: self.ground_effect,
            ground_turbulence: self.ground_turbulence,
            ground_turbulence_sample_time_s: self.sample_time,
        }
    }

    fn inputs(&self) -> Inputs {
        Inputs { rotor_command_rad_s: self.rotor_speed, wind_world_m_s: self.wind, effectiveness: self.effectiveness }
    }
}

impl Model for Quadcopter {
    fn init(&mut self, context: &mut Context) -> Result<(), Fault> {
        let parameters = self.parameters();
        if self.rotor_speed_min > self.rotor_speed_max {
            return Err(Fault::new("rotor_speed_min is above rotor_speed_max"));
        }
        self.plant = State::start(&parameters, self.position0, self.velocity0, self.yaw0, self.airborne);
        let (seed, stream) = (self.seed.unsigned_abs().into(), self.stream.unsigned_abs().into());
        self.turbulence = GroundTurbulence::new(seed, stream);
        self.turbulence.draw(context.past_samples(self.sample_time)?, self.sample_time);
        Ok(())
    }

    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault> {
        let stood = self.plant.contact();
        let parts = step.parts(INNER_STEP_S);
        let samples = (0..parts.count).map(|number| {
            let samples = step.part(parts, number).samples(self.sample_time);
            samples.end - samples.start
        });
        self.plant
            .step(&self.parameters(), &self.inputs(), parts.length_s, samples, &mut self.turbulence)
            .map_err(|not_finite| Fault::new(format!("the state cannot be computed: {not_finite}")))?;
        if self.plant.contact() != stood {
            let what = if stood { "leaves" } else { "touches" };
            context.event(|| format!("the vehicle {what} the ground at {} s", step.end_s()));
        }
        Ok(Outcome::Done)
    }

    fn outputs(&mut self, _time_s: f64) -> Result<(), Fault> {
        let body = &self.plant.body;
        self.state = vehicle::State {
            position: body.position_m,
            attitude: *body.attitude.quaternion(),
            velocity: body.velocity_world_m_s,
            rate: body.rate_body_rad_s,
        };
        [self.roll, self.pitch, self.yaw] = self.plant.roll_pitch_yaw_rad();
        self.rotor.speed = self.plant.rotor_speed_rad_s;
        self.height = body.position_m.z;
        self.contact = self.plant.contact();
        self.thrust = self.plant.thrust_n(&self.parameters(), &self.inputs(), &self.turbulence);
        Ok(())
    }
}

fmu::export!(Quadcopter);
