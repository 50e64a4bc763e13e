//! Builds the C units of `tests/foreign/` with the system's compiler and packs them: one with planted faults, one whose calls
//! run given code.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;

/// The folder of this platform below `binaries/`.
pub const PLATFORM: &str = if cfg!(target_arch = "x86_64") { "linux64" } else { "aarch64-linux" };

/// One Real output, `y`, of value reference 0.
pub const OUTPUT: &str =
    "<ScalarVariable name=\"y\" valueReference=\"0\" causality=\"output\"><Real/></ScalarVariable>";

/// The capabilities of a unit that saves its state.
pub const STATES: &str = "canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"";

/// The replacement in the description of a unit that declares that it saves its state.
pub const CLAIMS_STATES: (&str, &str) = (
    "canHandleVariableCommunicationStepSize=\"true\"",
    "canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"",
);

/// How the unit is built and packed.
#[derive(Debug)]
pub struct Foreign<'a> {
    /// Names and values for the compiler's `-D`; see `tests/foreign/unit.c`.
    pub defines: &'a [&'a str],
    /// The folder below `binaries/`.
    pub platform: &'a str,
    /// Texts of the description and their replacements.
    pub description: &'a [(&'a str, &'a str)],
}

impl Default for Foreign<'_> {
    fn default() -> Self {
        Self { defines: &[], platform: PLATFORM, description: &[] }
    }
}

#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
impl Foreign<'_> {
    /// Writes `foreign.fmu` into a temporary folder, which is removed when the returned `TempDir` is dropped.
    ///
    /// # Panics
    /// If the compiler is missing or fails, or the description lacks a text to replace.
    #[must_use]
    pub fn build(&self) -> (TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let defines: Vec<_> = self.defines.iter().map(|define| format!("-D{define}")).collect();
        let library = compile("unit.c", &defines, None, folder.path());
        let mut description = fs::read_to_string(sources().join("modelDescription.xml")).unwrap();
        for (from, to) in self.description {
            assert!(description.contains(from), "{from}");
            description = description.replace(from, to);
        }
        let fmu = folder.path().join("foreign.fmu");
        archive(&fmu, &description, &[(format!("binaries/{}/foreign.so", self.platform), &library)]);
        (folder, fmu)
    }
}

/// A unit of `tests/foreign/generic.c`, whose calls run the C code that a test gives.
#[derive(Debug, Default)]
pub struct Generic<'a> {
    /// Attributes of `CoSimulation`, besides the model identifier and the capability to take steps of any size, which the unit
    /// has unless it is named here.
    pub capabilities: &'a str,
    /// Elements that stand before `LogCategories`: `UnitDefinitions`, `TypeDefinitions`.
    pub definitions: &'a str,
    /// Elements that stand after `LogCategories`: `DefaultExperiment`, `VendorAnnotations`.
    pub experiment: &'a str,
    /// The `ScalarVariable`s. Those that are outputs are listed in `ModelStructure`, dependent on nothing.
    pub variables: &'a str,
    /// Macros of `generic.c`, each with its code: `("STEP_CODE", "R[1] = 2 * R[0];")`.
    pub code: &'a [(&'a str, &'a str)],
    /// A shared library that it needs, which is packed beside its own.
    pub beside: Option<&'a Path>,
}

#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
impl Generic<'_> {
    /// Writes `<name>.fmu` into a folder of its own, which is removed when the returned `TempDir` is dropped.
    ///
    /// # Panics
    /// If the compiler is missing or fails.
    #[must_use]
    pub fn build(&self, name: &str) -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        self.pack(folder.path(), name);
        folder
    }

    /// Writes `<name>.fmu` into the folder.
    ///
    /// # Panics
    /// If the compiler is missing or fails.
    pub fn pack(&self, folder: &Path, name: &str) -> PathBuf {
        let scratch = tempfile::tempdir().unwrap();
        let defines: Vec<_> = self.code.iter().map(|(macro_name, code)| format!("-D{macro_name}={code}")).collect();
        let library = compile("generic.c", &defines, self.beside, scratch.path());
        let fmu = folder.join(format!("{name}.fmu"));
        let entry = |file: &str| format!("binaries/{PLATFORM}/{file}");
        let beside = self.beside.map(|path| (entry(&path.file_name().unwrap().to_string_lossy()), path));
        let libraries: Vec<_> = beside.into_iter().chain([(entry(&format!("{name}.so")), library.as_path())]).collect();
        archive(&fmu, &self.description(name), &libraries);
        fmu
    }

    /// The text of `modelDescription.xml`.
    fn description(&self, name: &str) -> String {
        let (mut outputs, mut unknowns) = (String::new(), String::new());
        for (index, variable) in self.variables.split("<ScalarVariable").enumerate().skip(1) {
            let unknown = format!("<Unknown index=\"{index}\" dependencies=\"\"/>");
            let is_output = variable.contains("causality=\"output\"");
            if is_output {
                outputs += &unknown;
            }
            if variable.contains("\"calculatedParameter\"") || is_output && !variable.contains("initial=\"exact\"") {
                unknowns += &unknown;
            }
        }
        let list = |tag: &str, content: &str| match content {
            "" => String::new(),
            content => format!("<{tag}>{content}</{tag}>"),
        };
        let Self { capabilities, definitions, experiment, variables, .. } = self;
        let any_step = "canHandleVariableCommunicationStepSize";
        let any_step = if capabilities.contains(any_step) { String::new() } else { format!("{any_step}=\"true\"") };
        let structure = list("Outputs", &outputs) + &list("InitialUnknowns", &unknowns);
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiModelDescription fmiVersion=\"2.0\" modelName=\"{name}\" guid=\"g\">\n\
             <CoSimulation modelIdentifier=\"{name}\" {any_step} {capabilities}/>\n\
             {definitions}<LogCategories><Category name=\"logAll\"/></LogCategories>{experiment}\n\
             <ModelVariables>{variables}</ModelVariables>\n<ModelStructure>{structure}</ModelStructure>\n\
             </fmiModelDescription>\n"
        )
    }
}

fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("foreign")
}

/// Compiles a source of `tests/foreign/` to a shared library in the folder, which may need another one beside it.
#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
fn compile(source: &str, defines: &[String], beside: Option<&Path>, folder: &Path) -> PathBuf {
    let library = folder.join("unit.so");
    let compiled = Command::new("cc")
        .args([
            "-std=c11",
            "-D_DEFAULT_SOURCE",
            "-D_GNU_SOURCE",
            "-O1",
            "-fPIC",
            "-shared",
            "-fvisibility=hidden",
            "-w",
        ])
        .args(defines)
        .arg("-o")
        .arg(&library)
        .arg(sources().join(source))
        .args(beside)
        .args(["-Wl,-rpath,$ORIGIN", "-lm"])
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    library
}

/// Packs a description and libraries, each with its place in the archive.
#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
fn archive(fmu: &Path, description: &str, libraries: &[(String, &Path)]) {
    let mut archive = zip::ZipWriter::new(fs::File::create(fmu).unwrap());
    let options = SimpleFileOptions::default();
    archive.start_file("modelDescription.xml", options).unwrap();
    archive.write_all(description.as_bytes()).unwrap();
    for (entry, library) in libraries {
        archive.start_file(entry.as_str(), options).unwrap();
        archive.write_all(&fs::read(library).unwrap()).unwrap();
    }
    archive.finish().unwrap();
}
