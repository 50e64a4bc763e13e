//! Unit `wind`: the ports of `models::wind`.
#![forbid(unsafe_code)]

use fmu::{Context, Fault, FmiEnum, Fmu, Group, Model, Outcome, Step, vehicle};
use models::wind::{Inputs, Parameters, State};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Wind where a vehicle is: steady profile, Dryden turbulence, gusts.
#[derive(Fmu, Clone, Serialize, Deserialize)]
#[fmu(experiment(stop = 10.0, step = 0.01))]
struct Wind {
    /// Where the wind is wanted and how that place moves
    #[input]
    vehicle: vehicle::Motion,
    /// Steady wind, where it blows to, world frame; with the logarithmic profile at 20 ft
    #[input(start = [0.0; 3], unit = "m/s")]
    mean: Vector3<f64>,

    /// Velocity of the air over the ground, world frame
    #[output(unit = "m/s", depends(mean, vehicle.position), init(depends(
        vehicle, mean, profile, roughness, turbulence, sample_time, gust_count, gust, seed, stream,
    )))]
    velocity: Vector3<f64>,
    /// Speed of the air over the ground
    #[output(unit = "m/s", depends(mean, vehicle.position), init(depends(
        vehicle, mean, profile, roughness, turbulence, sample_time, gust_count, gust, seed, stream,
    )))]
    speed: f64,

    /// How the steady wind depends on height
    #[parameter(start = Profile::Uniform)]
    profile: Profile,
    /// Roughness length of the ground
    #[parameter(start = Parameters::default().roughness_m, unit = "m", min = 1e-6, max = 0.9)]
    roughness: f64,
    /// Wind speed at 20 ft that sets the strength of the turbulence, 0 for none; may change during a run
    #[parameter(tunable, start = 0.0, unit = "m/s", min = 0.0)]
    turbulence: f64,
    /// How long a sample of the turbulence holds
    #[parameter(start = Parameters::default().sample_time_s, unit = "s", min = 1e-4)]
    sample_time: f64,
    /// How many of the gusts count
    #[parameter(start = 0, min = 0, max = 8)]
    gust_count: i32,
    /// Gusts, each swelling and fading once
    #[group]
    gust: [Gust; 8],
    /// Seed of the turbulence
    #[parameter(start = 1, min = 0)]
    seed: i32,
    /// Stream of random numbers, apart from those of other units with this seed
    #[parameter(start = 0, min = 0)]
    stream: i32,

    air: State,
}

/// One swelling and fading of the wind
#[derive(Group, Clone, Serialize, Deserialize)]
struct Gust {
    /// When it begins
    #[parameter(start = 0.0, unit = "s")]
    start: f64,
    /// How long it lasts
    #[parameter(start = 0.0, unit = "s", min = 0.0)]
    duration: f64,
    /// Greatest speed, in the middle
    #[parameter(start = 0.0, unit = "m/s")]
    amplitude: f64,
    /// Where it blows to, counter-clockwise from east
    #[parameter(start = 0.0, unit = "rad", display = "deg")]
    direction: f64,
}

/// How the steady wind depends on height
#[derive(FmiEnum, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Profile {
    /// Equal at all heights
    Uniform,
    /// Logarithmic in the height
    Log,
}

impl Wind {
    fn parameters(&self) -> Parameters {
        Parameters {
            profile: match self.profile {
                Profile::Uniform => models::wind::Profile::Uniform,
                Profile::Log => models::wind::Profile::Log,
            },
            roughness_m: self.roughness,
            turbulence_m_s: self.turbulence,
            sample_time_s: self.sample_time,
        }
    }

    fn inputs(&self) -> Inputs {
        Inputs {
            mean_world_m_s: self.mean,
            vehicle_position_m: self.vehicle.position,
            vehicle_velocity_m_s: self.vehicle.velocity,
        }
    }

    /// The gusts that count.
    fn gusts(&self) -> &[Gust] {
        let count = usize::try_from(self.gust_count).unwrap_or(0);
        self.gust.get(..count).unwrap_or(&self.gust)
    }

    /// Logs the gusts that begin or end in a step.
    fn log_gusts(&self, step: Step, context: &mut Context) {
        let in_step = |time_s: f64| step.start_s() <= time_s && time_s < step.end_s();
        for (number, gust) in (1..).zip(self.gusts()) {
            if in_step(gust.start) {
                context.event(|| format!("gust {number} begins at {} s", gust.start));
            }
            if in_step(gust.start + gust.duration) {
                context.event(|| format!("gust {number} ends at {} s", gust.start + gust.duration));
            }
        }
    }
}

impl Model for Wind {
    fn init(&mut self, context: &mut Context) -> Result<(), Fault> {
        let (seed, stream) = (self.seed.unsigned_abs().into(), self.stream.unsigned_abs().into());
        let (parameters, inputs) = (self.parameters(), self.inputs());
        self.air = State::start(&parameters, &inputs, seed, stream);
        self.air.draw(&parameters, &inputs, context.past_samples(self.sample_time)?);
        Ok(())
    }

    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault> {
        let samples = step.samples(self.sample_time);
        self.air.draw(&self.parameters(), &self.inputs(), samples.end - samples.start);
        self.log_gusts(step, context);
        Ok(Outcome::Done)
    }

    fn outputs(&mut self, time_s: f64) -> Result<(), Fault> {
        let gust = |gust: &Gust| models::wind::Gust {
            start_s: gust.start,
            duration_s: gust.duration,
            amplitude_m_s: gust.amplitude,
            direction_rad: gust.direction,
        };
        let gusts = self.gust.each_ref().map(gust);
        let gusts = &gusts[..self.gusts().len()];
        self.velocity = self.air.velocity_world_m_s(&self.parameters(), &self.inputs(), gusts, time_s);
        self.speed = self.velocity.norm();
        Ok(())
    }
}

fmu::export!(Wind);
