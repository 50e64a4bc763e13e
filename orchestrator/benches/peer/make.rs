//! Builds the units of the benchmarks, in C and with the export layer.

use fmi2::description::write::write;
use fmi2::description::{
    Causality, CoSimulation, Kind, ModelDescription, RealAttributes, RealVariable, Variability, Variable,
};
use pack::UnitCrate;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use unit::describe::library_description;

const PLATFORM: &str = if cfg!(target_arch = "x86_64") { "linux64" } else { "aarch64-linux" };

/// Compiles `unit.c` as an unpacked unit.
pub fn in_c(ports: usize, folder: &Path) -> Result<ModelDescription, Box<dyn Error>> {
    let binaries = folder.join("binaries").join(PLATFORM);
    fs::create_dir_all(&binaries)?;
    let identifier = format!("chain{ports}");
    let status = Command::new("cc")
        .args(["-O2", "-shared", "-fPIC", "-fvisibility=hidden"])
        .arg(format!("-DPORTS={ports}"))
        .arg("-o")
        .arg(binaries.join(format!("{identifier}{}", std::env::consts::DLL_SUFFIX)))
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peer/unit.c"))
        .status()?;
    if !status.success() {
        return Err(format!("cc could not build the unit of the benchmark: {status}").into());
    }
    let description = ModelDescription {
        model_name: identifier.clone(),
        guid: identifier.clone(),
        co_simulation: Some(CoSimulation { model_identifier: identifier, ..CoSimulation::default() }),
        variables: (0..2 * ports).map(|reference| variable(reference, ports)).collect(),
        ..ModelDescription::default()
    };
    fs::write(folder.join("modelDescription.xml"), write(&description))?;
    Ok(description)
}

fn variable(reference: usize, ports: usize) -> Variable {
    let is_input = reference < ports;
    Variable {
        position: Default::default(),
        name: format!("{}[{}]", if is_input { "u" } else { "y" }, reference % ports + 1),
        value_reference: reference as u32,
        description: None,
        causality: if is_input { Causality::Input } else { Causality::Output },
        variability: Variability::Continuous,
        initial: None,
        can_handle_multiple_set_per_time_instant: None,
        annotations: Vec::new(),
        declared_type: None,
        kind: Kind::Real(RealVariable {
            start: is_input.then_some(0.0),
            attributes: RealAttributes::default(),
            ..RealVariable::default()
        }),
    }
}

/// The numbers of ports of the units of the export layer.
const PORTS: [usize; 2] = [1, 30];

/// Packs `relay.rs.in` with so many ports. Its crate is in the target folder, so that only the first build takes long.
pub fn packed(ports: usize) -> Result<PathBuf, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_TARGET_TMPDIR")).join("relays");
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let fmu = here.join("../fmus/fmu").canonicalize()?;
    let names = PORTS.map(|ports| format!("relay_{ports}"));
    for (name, ports) in names.iter().zip(PORTS) {
        let manifest = format!(
            "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\
             [package.metadata.fmu]\n[lib]\ncrate-type = [\"cdylib\"]\n\
             [dependencies]\nfmu = {{ path = {fmu:?} }}\nserde = {{ version = \"1\", features = [\"derive\"] }}\n"
        );
        let source = include_str!("relay.rs.in").replace("{{ports}}", &ports.to_string());
        write_if_changed(&workspace.join(name).join("Cargo.toml"), &manifest)?;
        write_if_changed(&workspace.join(name).join("src/lib.rs"), &source)?;
    }
    write_if_changed(&workspace.join("Cargo.toml"), &format!("[workspace]\nresolver = \"3\"\nmembers = {names:?}\n"))?;
    if !workspace.join("Cargo.lock").exists() {
        fs::copy(here.join("../Cargo.lock"), workspace.join("Cargo.lock"))?;
    }
    let unit = UnitCrate::at(&workspace.join(format!("relay_{ports}")))?;
    pack::pack(&unit, &library_description, &unit.archive(), &|_| ())?;
    Ok(unit.archive())
}

/// Writes a file unless it has this content: cargo would rebuild a file with a newer time.
fn write_if_changed(path: &Path, text: &str) -> std::io::Result<()> {
    if fs::read_to_string(path).is_ok_and(|present| present == text) {
        return Ok(());
    }
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::write(path, text)
}
