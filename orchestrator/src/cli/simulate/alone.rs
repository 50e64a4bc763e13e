//! A scenario of one unit alone, resolved as scripts are, so that what is wrong with `--set` is reported as in scripts.

use super::experiment::Experiment;
use super::input_file::Curves;
use super::start_values;
use crate::find::catalogue::Catalogue;
use crate::find::preparation::Refusal;
use crate::find::script::Script;
use dsl::diagnostic::Diagnostic;
use dsl::parse::parse_start_value;
use dsl::scenario::{Column, Connection, Drive, InitialStep, Port, Preset, Scenario};
use dsl::source::{Sources, Span};
use dsl::syntax::{Expression, ExpressionKind, File, Instance, Name, Statement, StatementKind, Word};
use fmi2::description::ModelDescription;
use std::path::Path;
use unit::archive::read_loadable;
use unit::error::UnitError;

/// How the text that diagnostics point into begins.
const COMMAND: &str = "lockstep simulate ";

/// A unit, found.
#[derive(Clone, Debug)]
pub(in crate::cli) struct Alone {
    /// As the user named it.
    pub unit: String,
    pub description: ModelDescription,
}

impl Alone {
    /// Finds a unit; paths are relative to the current folder.
    ///
    /// # Errors
    /// There is no such unit, or it cannot be read.
    pub fn find(unit: &str, catalogue: &Catalogue) -> Result<Self, Refusal> {
        let archive = catalogue.find(unit, Path::new("."));
        let archive = archive.map_err(|problem| Refusal::new(&problem.message, problem.help.as_deref()))?;
        let named = |error: UnitError| Refusal::new(&error.of_unit(unit), None);
        let (description, _) = read_loadable(&archive).map_err(named)?;
        Ok(Self { unit: unit.to_owned(), description })
    }

    /// The script, with its meaning: start values are set, curves drive their inputs, these columns are recorded.
    ///
    /// # Errors
    /// A start value that the description does not allow, or a variable with two of them.
    pub fn script(
        &self,
        experiment: &Experiment,
        settings: &[String],
        curves: Curves,
        columns: Vec<Column>,
        catalogue: &Catalogue,
    ) -> Result<Script, Refusal> {
        let mut presets = Vec::new();
        let mut others = Vec::new();
        for setting in settings {
            match start_values::bare(setting, &self.description) {
                Some(preset) => presets.push(preset),
                None => others.push(setting.as_str()),
            }
        }
        if let Some(wrong) = start_values::missed_limits(&presets, &self.description) {
            return Err(Refusal::new(&format!("--set: {wrong}"), Some("write a value within these limits")));
        }
        let mut sources = Sources::default();
        let line = sources.add("command line", format!("{COMMAND}{}", self.unit));
        let tree = self.tree(experiment, &others, &mut sources, line);
        let text = format!("{} {} {}\n{}", self.unit, experiment.step_s, experiment.stop_s, settings.join("\n"));
        let mut script = Script::of_tree(self.unit.clone(), text, sources, tree, catalogue);
        // The tree drives and records nothing: that is added to its meaning. The start of the experiment is observed here, and
        // another step is warned of in `experiment`.
        script.diagnostics.retain(|diagnostic| !["W02", "W06", "W07", "W08"].contains(&diagnostic.code));
        if let Some(scenario) = &mut script.scenario {
            let all = scenario.instances.iter().flat_map(|instance| &instance.presets).chain(&presets);
            if let Some(wrong) = start_values::given_twice(all, &self.description) {
                return Err(Refusal::new(&format!("--set: {wrong}"), Some("leave one of them")));
            }
            self.complete(scenario, presets, curves, columns);
            scenario.start_tick = experiment.start_tick;
        }
        Ok(script)
    }

    /// The tree of a script with one unit. Its places are those of the command line: the name of the unit in the text `line`,
    /// and the settings, each a text of its own.
    fn tree(
        &self,
        experiment: &Experiment,
        settings: &[&str],
        sources: &mut Sources,
        line: u32,
    ) -> Result<File, Vec<Diagnostic>> {
        let mut values = Vec::new();
        let mut wrong = Vec::new();
        for setting in settings {
            let text = sources.add("--set", *setting);
            match parse_start_value(sources, text) {
                Ok(value) => values.push(value),
                Err(diagnostics) => wrong.extend(diagnostics),
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let end = u32::try_from(COMMAND.len() + self.unit.len()).unwrap_or(u32::MAX);
        let span = Span { text: line, start: COMMAND.len() as u32, end };
        let word = |text: &str| Word { text: text.to_owned(), span };
        let seconds = |number| Expression {
            kind: ExpressionKind::Quantity { number, unit: Some(word("s")) },
            span,
            parenthesised: false,
        };
        let name = Name { word: word(&self.name_in_tree()), index: Vec::new(), span };
        let unit = Instance { name, unit: word(&self.unit), on: Vec::new(), every: Vec::new(), values };
        let statements = [
            StatementKind::Scenario(word(&format!("{} alone", self.unit))),
            StatementKind::Step(seconds(experiment.step_s)),
            StatementKind::Stop(seconds(experiment.stop_s)),
            StatementKind::Fmu(unit),
        ];
        let statement = |kind| Statement { kind, span, documentation: None };
        Ok(File { statements: statements.map(statement).into() })
    }

    /// The name of the unit, unless it means something else in values of `--set`.
    fn name_in_tree(&self) -> String {
        let name = self.name();
        let has_meaning = ["time", "seed", "pi"].contains(&name.as_str()) || fmi2::units::parse(&name).is_ok();
        if has_meaning { "unit".to_owned() } else { name }
    }

    fn complete(&self, scenario: &mut Scenario, presets: Vec<Preset>, curves: Curves, columns: Vec<Column>) {
        scenario.parameters.clear();
        scenario.columns = columns;
        scenario.connections = curves
            .into_iter()
            .map(|(variable, curve)| Connection {
                target: Port { instance: 0, variable },
                source: Drive::Curve(curve),
                direct: false,
            })
            .collect();
        if !scenario.connections.is_empty() {
            let connections = (0..scenario.connections.len()).collect();
            scenario.initialization = vec![InitialStep::Set { instance: 0, connections }];
        }
        for instance in &mut scenario.instances {
            instance.name = self.name();
            instance.presets.extend(presets.iter().cloned());
        }
    }

    /// What messages call the unit.
    pub fn name(&self) -> String {
        let stem = Path::new(&self.unit).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        stem.unwrap_or_else(|| self.unit.clone())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use dsl::scenario::{Curve, Value};
    use std::io::Write as _;
    use zip::write::SimpleFileOptions;

    const TANK: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Tank" guid="g">
  <CoSimulation modelIdentifier="tank" canHandleVariableCommunicationStepSize="true"/>
  <UnitDefinitions><Unit name="m2"><BaseUnit m="2"/></Unit>
    <Unit name="m"><BaseUnit m="1"/></Unit><Unit name="K"><BaseUnit K="1"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Mode"><Enumeration><Item name="Fill" value="1"/><Item name="Drain" value="2"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="area" valueReference="0" causality="parameter" variability="fixed"><Real unit="m2" min="0.5" start="1"/></ScalarVariable>
    <ScalarVariable name="inflow" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="0" causality="input" variability="discrete"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
    <ScalarVariable name="open" valueReference="0" causality="input" variability="discrete"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="level" valueReference="2" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="label" valueReference="0" causality="output" variability="discrete"><String/></ScalarVariable>
    <ScalarVariable name="gain" valueReference="3" causality="parameter" variability="tunable"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="depth" valueReference="4" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="rise" valueReference="5" causality="input"><Real unit="K" relativeQuantity="true" start="0"/></ScalarVariable>
    <ScalarVariable name="water" valueReference="6" causality="input"><Real unit="K" start="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="5"/><Unknown index="6"/></Outputs></ModelStructure>
</fmiModelDescription>"#;

    pub fn tank() -> ModelDescription {
        fmi2::description::read::read(TANK.as_bytes()).unwrap().0
    }

    fn level() -> Column {
        Column::of_port("level", Port { instance: 0, variable: 4 })
    }

    fn script(settings: &[&str], curves: Curves) -> Script {
        attempt(settings, curves).unwrap_or_else(|refusal| panic!("{}", refusal.0))
    }

    fn attempt(settings: &[&str], curves: Curves) -> Result<Script, Refusal> {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = zip::ZipWriter::new(std::fs::File::create(folder.path().join("tank.fmu")).unwrap());
        writer.start_file("modelDescription.xml", SimpleFileOptions::default()).unwrap();
        writer.write_all(TANK.as_bytes()).unwrap();
        let library = format!("binaries/{}/tank{}", fmi2::platform::FOLDERS[0], std::env::consts::DLL_SUFFIX);
        writer.start_file(library, SimpleFileOptions::default()).unwrap();
        writer.finish().unwrap();
        let catalogue = Catalogue::new(vec![folder.path().to_owned()], folder.path(), false).unwrap();
        let alone = Alone::find("tank", &catalogue).unwrap();
        let settings: Vec<_> = settings.iter().map(|&setting| setting.to_owned()).collect();
        let experiment = Experiment { start_tick: 0, stop_s: 2.0, step_s: 0.01, notes: Vec::new() };
        alone.script(&experiment, &settings, curves, vec![level()], &catalogue)
    }

    #[test]
    fn a_variable_gets_one_start_value_however_both_are_written() {
        for settings in [["area = 2", "area = 3"], ["area = 2", "area = 3 m2"], ["area = 2 m2", "area = 3"]] {
            let refusal = attempt(&settings, Vec::new()).map(drop).unwrap_err().0;
            assert_eq!(refusal, "error: --set: `area` gets two start values\nhelp: leave one of them", "{settings:?}");
        }
        let written = script(&["area = 2 m2", "area = 3 m2"], Vec::new());
        assert!(written.rendered(false).contains("error[E03]: `area` gets two start values"));
    }

    #[test]
    fn bare_values_and_quantities_become_presets_and_curves_connections() {
        let curve = Curve { rows: vec![(0.0, 1.0)], held: false };
        let script = script(&["area = 200", "inflow = 3", "mode = \"Drain\""], vec![(1, curve.clone())]);
        let scenario = script.scenario.unwrap_or_else(|| panic!("{:?}", script.diagnostics));
        assert_eq!((scenario.step_ns, scenario.stop_tick), (10_000_000, 200));
        let tank = &scenario.instances[0];
        let presets: Vec<_> = tank.presets.iter().map(|preset| (preset.variable, preset.value.clone())).collect();
        let expected = [(2, Value::Integer(2)), (0, Value::Real(200.0)), (1, Value::Real(3.0))];
        assert_eq!((tank.name.as_str(), presets.as_slice()), ("tank", expected.as_slice()));
        assert_eq!(scenario.connections[0].source, Drive::Curve(curve));
        assert_eq!(scenario.initialization, [InitialStep::Set { instance: 0, connections: vec![0] }]);
        assert_eq!(scenario.columns, [level()]);
    }

    #[test]
    fn what_is_wrong_with_a_setting_is_told_as_in_a_script_at_its_place_in_the_command_line() {
        let wrong = script(&["aera = 2", "area = 2 m", "level = 3", "mode = \"Spill\""], Vec::new());
        assert!(wrong.scenario.is_none());
        insta::assert_snapshot!(wrong.rendered(false));
    }
}
