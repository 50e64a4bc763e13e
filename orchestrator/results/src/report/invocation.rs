//! How the user started this program, so that the commands that the program itself offers can be pasted as they stand. What
//! `dsl` and `results` say about commands names them as `lockstep`.

use fmi2::printable;
use std::ffi::OsString;
use std::path::Path;
use std::sync::OnceLock;

/// The start of a command of this program: `lockstep`, the path by which it was started, or `cargo run --release --`.
#[must_use]
pub fn program() -> &'static str {
    static PROGRAM: OnceLock<String> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let package = std::env::var_os("CARGO_PKG_NAME");
        started_as(std::env::args_os().next().unwrap_or_default(), package)
    })
}

/// The start of a command, from the path by which the program was started and the package that `cargo run` says it runs.
fn started_as(path: OsString, package: Option<OsString>) -> String {
    let path = Path::new(&path);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        None => "lockstep".to_owned(),
        Some(folder) if path.ends_with("lockstep") && package.is_some_and(|package| package == "orchestrator") => {
            let profile = if folder.ends_with("release") { " --release" } else { "" };
            format!("cargo run{profile} --")
        }
        Some(_) => printable::shell_word(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hints_begin_as_the_program_was_started() {
        let started = |path: &str, package: Option<&str>| started_as(path.into(), package.map(OsString::from));
        assert_eq!(started("lockstep", None), "lockstep");
        assert_eq!(started("target/release/lockstep", Some("orchestrator")), "cargo run --release --");
        assert_eq!(started("target/debug/lockstep", Some("orchestrator")), "cargo run --");
        assert_eq!(started("./target/release/lockstep", None), "./target/release/lockstep");
        assert_eq!(started("/opt/my tools/lockstep", Some("tests")), "'/opt/my tools/lockstep'");
    }
}
