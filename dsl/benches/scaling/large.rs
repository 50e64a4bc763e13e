//! Scripts and descriptions of any size, for the benchmark and for the tests of linear cost.

use std::fmt::Write;
use std::sync::Arc;

use dsl::diagnostic::render;
use dsl::loader::{Loader, Problem, Table};
use dsl::parse::parse;
use dsl::parts::Parts;
use dsl::resolve::{Request, resolve};
use dsl::source::{Source, Sources};
use fmi2::description::ModelDescription;
use fmi2::description::read::read;

/// What every script begins with.
const HEAD: &str = "scenario \"Large\"\nstep 10 ms\nstop 60 s\n";

/// A text out of one piece for each number from 1.
fn each(count: usize, piece: impl Fn(&mut String, usize) -> std::fmt::Result) -> String {
    let mut text = String::new();
    for number in 1..=count {
        assert!(piece(&mut text, number).is_ok(), "a text takes what is written to it");
    }
    text
}

/// `count` connections: half of them give the inputs of a unit a value, the others go from its outputs, of which each may
/// depend on all inputs, to the inputs of a second unit.
pub fn connections_of_two_units(count: usize) -> String {
    let values = each(count / 2, |text, n| writeln!(text, "{n} m -> a.u[{n}]"));
    let wires = each(count / 2, |text, n| writeln!(text, "a.y[{n}] -> b.u[{n}]"));
    format!("{HEAD}fmu a = \"large\"\nfmu b = \"large\"\n{values}{wires}")
}

/// A chain of `count` instances.
pub fn connections_of_many_instances(count: usize) -> String {
    let instances = each(count, |text, n| writeln!(text, "fmu a{n} = \"small\""));
    let wires = each(count - 1, |text, n| writeln!(text, "a{n}.y[1] => a{}.u[1]", n + 1));
    format!("{HEAD}{instances}{wires}")
}

/// `count` lines: half of them comments, the others names and claims.
pub fn lines(count: usize) -> String {
    let lines = each(count / 4, |text, n| {
        writeln!(text, "# The distance number {n}.\nlet d{n} = abs(a.y[1] - {n} m)\n\nassert c{n}: always d{n} < 3 m")
    });
    format!("{HEAD}fmu a = \"small\" {{ u[1] = 1 m }}\n{lines}")
}

/// `count` names that are declared nowhere.
pub fn undefined_names(count: usize) -> String {
    format!("{HEAD}{}", each(count, |text, n| writeln!(text, "let a{n} = b{n}")))
}

/// `count` declarations of one name.
pub fn duplicate_names(count: usize) -> String {
    format!("{HEAD}{}", each(count, |text, _| writeln!(text, "let a = 1")))
}

/// A third as many lists of 30 distances as there are connections, which do not use them.
pub fn lists_of_distances(connections: usize) -> String {
    let distance = |text: &mut String, list: usize, n: usize| {
        write!(text, "dist([{list}, {n}, 0] m, [a.y[1], a.y[2], a.y[{n}]]), ")
    };
    let lists = each(connections / 3, |text, list| {
        write!(text, "let l{list} = [")?;
        (1..=30).try_for_each(|n| distance(text, list, n))?;
        writeln!(text, "]")
    });
    let wires = each(connections, |text, n| writeln!(text, "a.y[{n}] -> b.u[{n}]"));
    format!("{HEAD}fmu a = \"large\" {{ u[1] = 1 m }}\nfmu b = \"large\"\n{lists}{wires}")
}

/// `count` windows, one after the other, over one input.
pub fn windows(count: usize) -> String {
    let windows = each(count, |text, n| writeln!(text, "at {n} ms lasting 1 ms {{ set a.u[1] = {n} m }}"));
    format!("scenario \"Large\"\nstep 1 ms\nstop {} ms\nfmu a = \"small\" {{ u[1] = 1 m }}\n{windows}", count + 10)
}

/// `count` lines that are not statements.
pub fn syntax_errors(count: usize) -> String {
    format!("{HEAD}{}", each(count, |text, n| writeln!(text, "let a{n} {n}")))
}

/// A unit with `ports` inputs and `ports` outputs, which name no dependencies.
pub fn description(ports: usize) -> String {
    let variables = each(ports, |text, n| {
        write!(
            text,
            "<ScalarVariable name='u[{n}]' valueReference='{n}' causality='input'><Real unit='m' start='0'/>"
        )?;
        write!(text, "</ScalarVariable>")
    }) + &each(ports, |text, n| {
        write!(text, "<ScalarVariable name='y[{n}]' valueReference='{}' causality='output'>", ports + n)?;
        write!(text, "<Real unit='m'/></ScalarVariable>")
    });
    let outputs = each(ports, |text, n| write!(text, "<Unknown index='{}'/>", ports + n));
    of_variables(&variables, &outputs)
}

/// A unit whose `count` variables have a causality, a type and a unit of measure that do not exist.
pub fn bad_variables(count: usize) -> String {
    let variables = each(count, |text, n| {
        write!(text, "<ScalarVariable name='x{n}' valueReference='{n}' causality='inward'>")?;
        write!(text, "<Real unit='furlong' declaredType='Distance' start='nothing'/></ScalarVariable>")
    });
    of_variables(&variables, "")
}

fn of_variables(variables: &str, outputs: &str) -> String {
    format!(
        "<?xml version='1.0' encoding='UTF-8'?><fmiModelDescription fmiVersion='2.0' modelName='large' guid='large'>\
         <CoSimulation modelIdentifier='large'/>\
         <UnitDefinitions><Unit name='m'><BaseUnit m='1'/></Unit></UnitDefinitions>\
         <ModelVariables>{variables}</ModelVariables>\
         <ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure>\
         </fmiModelDescription>"
    )
}

/// A unit with two ports and one with many.
pub struct Units {
    small: Arc<ModelDescription>,
    large: Arc<ModelDescription>,
}

/// Units with two and with `ports` ports.
pub fn units(ports: usize) -> Units {
    let unit = |ports| match read(description(ports).as_bytes()) {
        Ok((read, _)) => Arc::new(read),
        Err(finding) => panic!("the description of {ports} ports: {finding}"),
    };
    Units { small: unit(2), large: unit(ports) }
}

impl Loader for Units {
    fn unit(&self, _: &Source, name: &str) -> Result<Arc<ModelDescription>, Problem> {
        Ok(Arc::clone(if name == "small" { &self.small } else { &self.large }))
    }

    fn text(&self, _: &Source, path: &str) -> Result<Source, Problem> {
        Err(Problem { message: format!("there is no text `{path}`"), help: None })
    }

    fn file(&self, _: &Source, _: &str) -> Result<(), Problem> {
        Ok(())
    }

    fn table(&self, _: &Source, path: &str) -> Result<Table, Problem> {
        Err(Problem { message: format!("there is no table `{path}`"), help: None })
    }
}

/// From a script's text to its findings as a user reads them, or to its scenario.
pub fn understand(script: &str, units: &Units) -> (bool, String) {
    let mut sources = Sources::default();
    let text = sources.add("large.scn", script);
    let parsed = parse(&sources, text);
    if !parsed.diagnostics.is_empty() {
        return (false, render(&sources, &parsed.diagnostics, false));
    }
    let resolved = resolve(&Request {
        sources: &sources,
        file: &parsed.file,
        parts: &Parts::default(),
        loader: units,
        settings: &[],
        case: None,
        isolated: false,
    });
    (resolved.scenario.is_some(), render(&sources, &resolved.diagnostics, false))
}
