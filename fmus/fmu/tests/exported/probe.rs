//! A unit with a port of each kind, whose steps fail on demand.

use fmu::{Context, Fault, FmiEnum, Fmu, Library, Model, Outcome, Step};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Unit with a port of each kind.
#[derive(Fmu, Clone, Serialize, Deserialize)]
#[fmu(experiment(stop = 10.0, step = 0.1))]
pub struct Probe {
    /// What the next step does
    #[input(start = Deed::Nothing)]
    deed: Deed,
    /// Speed
    #[input(start = 1.0, unit = "m/s", display = "km/h")]
    speed: f64,
    /// Two counters
    #[input(start = [3, 4], min = -5, max = 5)]
    count: [i32; 2],
    /// A switch
    #[input]
    switch: bool,
    /// A text
    #[input(start = "quiet")]
    text: String,
    /// A fixed number
    #[parameter(start = 2.0, unit = "1", min = 0.0, max = 10.0)]
    gain: f64,
    /// A number that may change
    #[parameter(tunable, start = 0.0, unit = "m/s")]
    offset: f64,
    /// Where the unit starts, and is
    #[output(exact = [0.0, 0.0, 1.0], unit = "m")]
    position: Vector3<f64>,
    /// Speed with gain and offset
    #[output(unit = "m/s", depends(speed, gain, offset))]
    scaled: f64,
    /// Sum of the counters
    #[output(depends(count))]
    sum: i32,
    /// The text again
    #[output(depends(text))]
    echo: String,
    /// The other position of the switch
    #[output(depends(switch))]
    inverse: bool,
    /// Length of the last step
    #[local(unit = "s")]
    step_length: f64,
    steps: u64,
}

/// The speed at which [`Deed::Panic`] panics.
pub const UNLUCKY_M_S: f64 = 13.0;

/// The speed at which there are no outputs.
pub const HUGE_M_S: f64 = 1e20;

/// What a step does.
#[derive(FmiEnum, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Deed {
    /// It is made
    Nothing,
    /// It is made, with a warning
    Warn,
    /// Half of it is made
    Discard,
    /// The unit comes to its end
    Terminate,
    /// It cannot be made
    Fail,
    /// It panics at the speed [`UNLUCKY_M_S`]
    Panic,
}

impl Model for Probe {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        self.step_length = 0.0;
        self.steps = 0;
        Ok(())
    }

    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault> {
        let outcome = match self.deed {
            Deed::Nothing => Outcome::Done,
            Deed::Warn => {
                context.warn("100% of #1");
                context.event(|| "warned".to_owned());
                Outcome::Done
            }
            Deed::Discard => Outcome::AcceptedUntil(step.start_s() + step.length_s() / 2.0),
            Deed::Terminate => Outcome::Terminated(step.end_s()),
            Deed::Fail => return Err(Fault::new("told to")),
            // Not at the values that the common tests of every unit try.
            Deed::Panic => {
                assert!(self.speed != UNLUCKY_M_S, "told to panic");
                Outcome::Done
            }
        };
        self.position.x += self.speed * step.length_s();
        self.step_length = step.length_s();
        self.steps += 1;
        Ok(outcome)
    }

    fn outputs(&mut self, _: f64) -> Result<(), Fault> {
        self.scaled = self.gain * self.speed + self.offset;
        self.sum = self.count.iter().sum();
        self.echo.clone_from(&self.text);
        self.inverse = !self.switch;
        if self.speed == HUGE_M_S { Err(Fault::new("too fast for an output")) } else { Ok(()) }
    }
}

fmu::export!(Probe);

/// Value references in the description.
pub mod port {
    pub static DEED: u32 = 0;
    pub static COUNT: [u32; 2] = [1, 2];
    pub static SUM: u32 = 3;
    pub static SPEED: u32 = 0;
    pub static GAIN: u32 = 1;
    pub static OFFSET: u32 = 2;
    pub static POSITION_X: u32 = 3;
    pub static SCALED: u32 = 6;
    pub static STEP_LENGTH: u32 = 7;
    pub static SWITCH: u32 = 0;
    pub static INVERSE: u32 = 1;
    pub static TEXT: u32 = 0;
    pub static ECHO: u32 = 1;
}

#[test]
fn the_value_references_equal_those_of_the_description() {
    let (description, _) = fmi2::description::read::read(LIBRARY.xml().as_bytes()).expect("readable");
    let reference = |name: &str| description.variables[description.variable(name).expect(name)].value_reference;
    assert_eq!(["deed", "count[1]", "count[2]", "sum"].map(reference), [0, 1, 2, 3]);
    assert_eq!(["speed", "gain", "offset", "position.x", "scaled", "step_length"].map(reference), [0, 1, 2, 3, 6, 7]);
    assert_eq!(["switch", "inverse"].map(reference), [port::SWITCH, port::INVERSE]);
    assert_eq!(["text", "echo"].map(reference), [port::TEXT, port::ECHO]);
}

pub fn library() -> &'static Library {
    &LIBRARY
}

pub fn guid() -> String {
    let xml = LIBRARY.xml();
    let (_, rest) = xml.split_once("guid=\"").expect("a GUID");
    rest.split('"').next().expect("its end").to_owned()
}
