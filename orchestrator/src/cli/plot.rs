//! `lockstep plot`: a picture of a run.

use dsl::nearest::nearest;
use fmi2::printable;
use results::plot::{PlotError, Selection, draw};
use results::report;
use results::run_folder::PLOT_SVG;
use results::table::Table;
use std::ffi::OsStr;
use std::path::PathBuf;

/// Draws paths and signals of a run as SVG.
#[derive(Debug, clap::Args)]
pub struct Plot {
    /// The folder of a run, or a table over time: CSV or Parquet
    run: PathBuf,
    /// Columns or groups, for example quad.state.position or quad.roll,quad.pitch (one panel); without any: all paths and
    /// the first groups
    signals: Vec<String>,
    /// Where the picture goes [default: plot.svg in the run's folder]
    #[arg(long, value_name = "F.svg")]
    out: Option<PathBuf>,
    /// Mark the first path with letters wherever this column changes, for example path.leg
    #[arg(long, value_name = "SIGNAL")]
    mark: Option<String>,
}

impl Plot {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(self) -> u8 {
        if let Some(out) = self.out.as_ref().filter(|out| out.extension() != Some(OsStr::new("svg"))) {
            let message = format!("--out {} is no name of a picture", printable::path(out));
            report::error(&message, Some("pictures are SVG: let it end in .svg"));
            return 2;
        }
        let table = match Table::read(&self.run) {
            Ok(table) => table,
            Err(error) => {
                let help = "name the folder that `lockstep run` said, for example runs/first_flight";
                report::error(&error, Some(error.help.as_deref().unwrap_or(help)));
                return 2;
            }
        };
        let title = self.run.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let selection = Selection { signals: self.signals, mark: self.mark };
        let picture = match draw(&title, &table, &selection) {
            Ok(picture) => picture,
            Err(error) => {
                let names: Vec<_> = table.names().collect();
                report::error(&message(&error, &names), Some(&format!("recorded are: {}", names.join(", "))));
                return 2;
            }
        };
        let beside = if self.run.is_dir() { self.run.join(PLOT_SVG) } else { self.run.with_extension("svg") };
        let out = self.out.unwrap_or(beside);
        if let Err(error) = std::fs::write(&out, picture) {
            report::error(&format!("cannot write {}: {error}", printable::path(out)), None);
            return 2;
        }
        if table.partial {
            report::status("note: this run did not come to its end; the picture shows what was recorded");
        }
        report::result(&format!("{}\n", printable::path(out)));
        0
    }
}

/// An error with the name that was probably meant.
fn message(error: &PlotError, names: &[&str]) -> String {
    let near = match error {
        PlotError::Unknown(name) => nearest(name, names.iter().copied()),
        PlotError::Empty => None,
    };
    near.map_or_else(|| error.to_string(), |near| format!("{error}; did you mean `{near}`?"))
}
