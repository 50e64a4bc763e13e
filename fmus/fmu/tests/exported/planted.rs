//! Units with a planted mistake: each of the tests that every unit gets detects its own.

use fmu::testing::{
    a_saved_state_goes_on_bit_for_bit, finite_values_give_finite_outputs_or_a_fault, init_can_be_repeated,
    outputs_depend_on_what_they_declare, the_description_keeps_every_rule_of_the_standard,
};
use fmu::{Context, Fault, Fmu, Library, Model, Outcome, Package, Step};
use serde::{Deserialize, Serialize};

const PACKAGE: Package = Package { identifier: "planted", version: "1.0.0", authors: "", license: "MIT" };

/// Each output is wrong in its own way but the last three.
#[derive(Fmu, Clone, Serialize, Deserialize)]
struct Wrong {
    /// Declared by nobody
    #[input(unit = "m")]
    input: f64,
    /// Declared by nobody
    #[parameter(start = 1.0, unit = "1")]
    gain: f64,
    /// Wrong bounds
    #[parameter(start = 3.0, unit = "1", max = 1.0 + 1.0)]
    bound: f64,
    /// Moves with the input at once
    #[output(unit = "m", depends(), init(depends(input)))]
    at_once: f64,
    /// Follows its input in `step` only
    #[output(unit = "m", depends(input))]
    sampled: f64,
    /// Depends on less at the start
    #[output(unit = "m", depends(), init(depends(gain, bound)))]
    less: f64,
    /// Moves with the parameter at the start
    #[output(unit = "1", depends())]
    at_start: f64,
    /// Moves with time, as a state may
    #[output(unit = "m", depends())]
    state: f64,
    /// Moves with what it declares
    #[output(unit = "m", depends(input))]
    honest: f64,
    /// Moves with what it declares where the gain is negative
    #[output(unit = "m", depends(input), init(depends(input, gain)))]
    sometimes: f64,
    /// Adds up the calls of `init`
    starts: u32,
    /// Is lost on the way
    #[serde(skip)]
    forgotten: f64,
}

impl Model for Wrong {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        (self.at_start, self.sampled, self.less, self.state) = (self.gain, self.input, self.gain, 0.0);
        self.starts += 1;
        Ok(())
    }

    fn step(&mut self, step: Step, _: &mut Context) -> Result<Outcome, Fault> {
        self.forgotten += 1.0;
        self.sampled = self.input;
        self.state += self.input * step.length_s() * self.forgotten;
        Ok(Outcome::Done)
    }

    fn outputs(&mut self, _: f64) -> Result<(), Fault> {
        (self.at_once, self.honest) = (self.input, self.input);
        self.sometimes = if self.gain < 0.0 { self.input } else { 0.0 };
        Ok(())
    }
}

static WRONG: Library = Library::of::<Wrong>(PACKAGE);

#[test]
fn undeclared_and_superfluous_dependencies_are_found_and_nothing_else() {
    let found = outputs_depend_on_what_they_declare(&WRONG).expect_err("four mistakes");
    assert_eq!(
        found.0,
        [
            "`at_once` moves with `input` at once, which it does not declare",
            "`at_start` moves with `gain` at the start, which it does not declare",
            "`less` declares `bound` for the start, but never moves with it there: leave it out",
            "`sampled` declares `input`, but does not move with it at once: compute it in `outputs`, or leave the name out",
        ]
    );
}

#[test]
fn a_start_value_outside_its_bounds_is_found() {
    let found = the_description_keeps_every_rule_of_the_standard(&WRONG).expect_err("one mistake");
    assert!(found.0.len() == 1 && found.0[0].contains("bound"), "{found:?}");
}

#[test]
fn an_init_that_counts_its_calls_is_found() {
    let found = init_can_be_repeated(&WRONG).expect_err("one mistake");
    assert_eq!(found.0[0], "a second `init` changes what the first one left");
}

/// Whose hidden state does not reach the bytes.
#[derive(Fmu, Clone, Serialize, Deserialize)]
struct Forgetful {
    /// Distance
    #[output(exact = 0.0, unit = "m")]
    distance: f64,
    /// Is lost on the way
    #[serde(skip)]
    speed_m_s: f64,
}

impl Model for Forgetful {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        self.speed_m_s = 0.0;
        Ok(())
    }

    fn step(&mut self, step: Step, _: &mut Context) -> Result<Outcome, Fault> {
        self.speed_m_s += step.length_s();
        self.distance += self.speed_m_s * step.length_s();
        Ok(Outcome::Done)
    }
}

static FORGETFUL: Library = Library::of::<Forgetful>(PACKAGE);

#[test]
fn hidden_state_that_is_not_written_is_found() {
    let found = a_saved_state_goes_on_bit_for_bit(&FORGETFUL).expect_err("one mistake");
    assert_eq!(found.0, ["a unit read from bytes goes on otherwise: `Serialize` leaves something out"]);
}

/// Its outputs change states, and it panics at a large input.
#[derive(Fmu, Clone, Serialize, Deserialize)]
struct Restless {
    /// Length
    #[input(unit = "m")]
    length: f64,
    /// The length again
    #[output(unit = "m", depends(length))]
    echo: f64,
    /// The last length that `outputs` met
    last_m: f64,
    /// Counts calls of `outputs` for lengths below zero
    calls: u32,
}

impl Model for Restless {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        (self.last_m, self.calls) = (0.0, 0);
        Ok(())
    }

    fn step(&mut self, _: Step, _: &mut Context) -> Result<Outcome, Fault> {
        assert!(self.length < 1e100, "too long");
        Ok(Outcome::Done)
    }

    fn outputs(&mut self, _: f64) -> Result<(), Fault> {
        self.echo = self.length;
        self.last_m = self.last_m.max(self.length);
        self.calls += u32::from(self.length < 0.0);
        Ok(())
    }
}

static RESTLESS: Library = Library::of::<Restless>(PACKAGE);

#[test]
fn outputs_that_change_a_state_are_found() {
    let found = outputs_depend_on_what_they_declare(&RESTLESS).expect_err("two mistakes");
    assert_eq!(
        found.0,
        [
            "`outputs` changes a state: the unit remembers that `length` had another value",
            "a second `outputs` changes what the first one left: it must not change a state",
        ]
    );
}

#[test]
fn a_panic_at_a_large_value_is_found_with_the_value() {
    let found = finite_values_give_finite_outputs_or_a_fault(&RESTLESS).expect_err("one mistake");
    assert!(found.0.len() == 1 && found.0[0].starts_with("it panics: too long, with length = Real("), "{found:?}");
}
