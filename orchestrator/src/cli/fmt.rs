//! `lockstep fmt`: scripts in one style.

use super::exit_code;
use dsl::diagnostic::render;
use dsl::format::format;
use dsl::source::Sources;
use fmi2::printable;
use results::report;
use results::report::console::has_colour;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Formats scripts in the one style of the language.
///
/// Changes blanks and line breaks, and `m/s2` to `m/s^2`; comments stay. A script with syntax errors is left as it is, with
/// exit code 2.
#[derive(Debug, clap::Args)]
pub struct Fmt {
    /// Scripts; `-` reads standard input and writes standard output
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Write nothing; name the scripts that have another style, and end with 1 if there are any
    #[arg(long)]
    check: bool,
}

/// What was found out about one script.
enum Formatted {
    /// It has the style already.
    Same,
    /// It had another style.
    Changed,
    /// It has syntax errors, or cannot be read or written; the reason was printed.
    Refused,
}

impl Fmt {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let (mut changed, mut refused) = (false, false);
        for file in &self.files {
            match self.one(file) {
                Formatted::Same => {}
                Formatted::Changed => changed = true,
                Formatted::Refused => refused = true,
            }
        }
        match (refused, changed && self.check) {
            (true, _) => exit_code::USAGE,
            (false, true) => exit_code::FAILED,
            (false, false) => 0,
        }
    }

    fn one(&self, file: &Path) -> Formatted {
        let is_input = file == Path::new("-");
        let name = if is_input { "standard input".to_owned() } else { printable::path(file) };
        let bytes = if is_input { of_standard_input() } else { fs::read(file) };
        let text = bytes.and_then(|bytes| {
            String::from_utf8(bytes)
                .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("it is not UTF-8: {error}")))
        });
        let text = match text {
            Ok(text) => text,
            Err(error) => return refused(&format!("cannot read {name}: {error}")),
        };
        let mut sources = Sources::default();
        let index = sources.add(name.as_str(), text.as_str());
        let styled = match format(&sources, index) {
            Ok(styled) => styled,
            Err(errors) => {
                report::diagnostics(render(&sources, &errors, has_colour(&io::stderr())).trim_end());
                return Formatted::Refused;
            }
        };
        let is_same = styled == text;
        match (self.check, is_input) {
            (true, _) if !is_same => report::result(&difference(&name, &text, &styled)),
            (false, true) => report::rendered_result(&styled),
            (false, false) if !is_same => {
                if let Err(error) = replace(file, &styled) {
                    return refused(&format!("cannot write {name}: {error}"));
                }
            }
            _ => {}
        }
        if is_same { Formatted::Same } else { Formatted::Changed }
    }
}

fn refused(message: &str) -> Formatted {
    report::error(&message, None);
    Formatted::Refused
}

fn of_standard_input() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Replaces a file as a whole: what reads it sees the old or the new text. A link keeps its place, the file its permissions.
fn replace(file: &Path, text: &str) -> io::Result<()> {
    let file = file.canonicalize()?;
    let folder = file.parent().unwrap_or(Path::new("."));
    let permissions = fs::metadata(&file)?.permissions();
    if permissions.readonly() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only"));
    }
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let partial = folder.join(format!(".{name}.{}.partial", std::process::id()));
    let written = fs::File::create_new(&partial).and_then(|mut new| {
        new.write_all(text.as_bytes())?;
        new.set_permissions(permissions)?;
        new.sync_all()
    });
    let replaced = written.and_then(|()| fs::rename(&partial, &file));
    if replaced.is_err() {
        // The error that is reported is the one above.
        let _ = fs::remove_file(&partial);
    }
    replaced
}

/// The name of a script, and the first lines that differ from the style.
fn difference(name: &str, text: &str, styled: &str) -> String {
    const LINES_SHOWN: usize = 3;
    let (old, new): (Vec<_>, Vec<_>) = (text.lines().collect(), styled.lines().collect());
    let mut shown = format!("{name}: not formatted\n");
    let common = old.iter().zip(&new).take_while(|(old, new)| old == new).count();
    let end = old[common..].iter().rev().zip(new[common..].iter().rev()).take_while(|(old, new)| old == new).count();
    let changed = |lines: &[&str], sign: &str| {
        let changed = &lines[common..lines.len() - end];
        changed.iter().take(LINES_SHOWN).map(|line| format!("  {sign} {line}\n")).collect::<String>()
    };
    let (old, new) = (changed(&old, "-"), changed(&new, "+"));
    if !(old.is_empty() && new.is_empty()) {
        shown.push_str(&format!("  line {}\n{old}{new}", common + 1));
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_difference_shows_the_first_lines_that_change() {
        let shown = difference("a.scn", "step 1 s\nlet a=3\nstop 2 s\n", "step 1 s\nlet a = 3\nstop 2 s\n");
        assert_eq!(shown, "a.scn: not formatted\n  line 2\n  - let a=3\n  + let a = 3\n");
        assert_eq!(difference("a.scn", "step 1 s", "step 1 s\n"), "a.scn: not formatted\n");
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_and_keeps_its_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.scn");
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        replace(&file, "new").unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
