//! A scenario of one unit alone, written as a script, so that errors in it are reported as in scripts.

use super::column_name::column_name;
use super::experiment::Experiment;
use super::input_file::Curves;
use super::start_values;
use crate::find::catalogue::Catalogue;
use crate::find::preparation::Refusal;
use crate::find::script::Script;
use dsl::scenario::{Column, Connection, Drive, InitialStep, Port, Preset, Scenario};
use fmi2::description::{BaseType, Causality, ModelDescription};
use results::shortest_decimal;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use unit::archive::read_loadable;
use unit::error::UnitError;

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

    /// The script, with its meaning: start values are set, curves drive their inputs, every port is recorded.
    ///
    /// # Errors
    /// A start value that the description does not allow.
    pub fn script(
        &self,
        experiment: &Experiment,
        settings: &[String],
        curves: Curves,
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
        let text = self.text(experiment, &others);
        let mut script = Script::of_text("lockstep simulate".to_owned(), PathBuf::from("."), text, &[], catalogue);
        // The inner script drives and records nothing: that is added to its meaning. The start of the experiment is observed
        // here, and another step is warned of in `experiment`.
        script.diagnostics.retain(|diagnostic| !["W02", "W06", "W07", "W08"].contains(&diagnostic.code));
        script.name.clone_from(&self.unit);
        if let Some(scenario) = &mut script.scenario {
            self.complete(scenario, presets, curves);
            scenario.start_tick = experiment.start_tick;
        }
        Ok(script)
    }

    fn text(&self, experiment: &Experiment, settings: &[&str]) -> String {
        let (step, stop) = (shortest_decimal(experiment.step_s), shortest_decimal(experiment.stop_s));
        let mut text = format!("scenario \"{0} alone\"\nstep {step} s\nstop {stop} s\nfmu unit = \"{0}\"", self.unit);
        if !settings.is_empty() {
            let _ = write!(text, " {{\n  {}\n}}", settings.join("\n  "));
        }
        text + "\n"
    }

    fn complete(&self, scenario: &mut Scenario, presets: Vec<Preset>, curves: Curves) {
        scenario.parameters.clear();
        scenario.columns = self.columns();
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

    /// Outputs, then inputs, under their own names.
    fn columns(&self) -> Vec<Column> {
        let of = |causality| {
            let variables = self.description.variables.iter().enumerate();
            variables.filter(move |(_, variable)| {
                variable.causality == causality && variable.base_type() != BaseType::String
            })
        };
        let ports = of(Causality::Output).chain(of(Causality::Input));
        ports
            .map(|(index, variable)| Column {
                name: column_name(&variable.name, &self.description),
                port: Port { instance: 0, variable: index },
            })
            .collect()
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

    fn script(settings: &[&str], curves: Curves) -> Script {
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
        alone
            .script(
                &Experiment { start_tick: 0, stop_s: 2.0, step_s: 0.01, notes: Vec::new() },
                &settings,
                curves,
                &catalogue,
            )
            .unwrap()
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
        let columns: Vec<_> = scenario.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(columns, ["level", "inflow", "mode", "open", "depth", "rise", "water"]);
    }

    #[test]
    fn what_is_wrong_with_a_setting_is_told_as_in_a_script() {
        let script = script(&["aera = 2", "area = 2 m", "level = 3", "mode = \"Spill\""], Vec::new());
        assert!(script.scenario.is_none());
        insta::assert_snapshot!(script.rendered(false));
    }
}
