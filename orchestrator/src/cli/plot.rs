//! `lockstep plot`: a picture of runs.

use super::simulate::experiment;
use dsl::nearest::nearest;
use fmi2::printable;
use results::plot::{Drawing, Mesh, PlotError, Raster, Run, Selection, ViewFrom, draw};
use results::report;
use results::run_folder::PLOT_SVG;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// Draws paths, signals, limits of claims and windows of a run as SVG or PNG.
#[derive(Debug, clap::Args)]
pub struct Plot {
    /// The folder of a run, or a table over time: CSV or Parquet
    run: PathBuf,
    /// Columns, groups or claims, for example quad.state.position or quad.roll,quad.pitch (one panel); without any: all
    /// paths, what the claims are about, and the first groups. The folder of another run is laid over the first
    #[arg(value_name = "RUN|SIGNAL")]
    signals: Vec<String>,
    /// Where the picture goes; one that ends in .png is drawn by pixels [default: plot.svg in the run's folder]
    #[arg(long, value_name = "F.svg|F.png")]
    out: Option<PathBuf>,
    /// Draw a PNG beside the SVG
    #[arg(long)]
    png: bool,
    /// Pixels of the PNG for each of the SVG
    #[arg(long, value_name = "NUMBER", default_value = "2")]
    scale: f64,
    /// The width in pixels of the SVG [default: 960]
    #[arg(long, value_name = "PIXELS")]
    width: Option<f64>,
    /// The first time that is drawn, for example 10s
    #[arg(long, value_name = "TIME", value_parser = experiment::start)]
    from: Option<f64>,
    /// The last time that is drawn
    #[arg(long, value_name = "TIME", value_parser = experiment::start)]
    to: Option<f64>,
    /// Mark the first path with letters wherever this column changes, for example path.leg
    #[arg(long, value_name = "SIGNAL")]
    mark: Option<String>,
    /// Draw an enumeration, an Integer or a Boolean as coloured bands over all panels, for example ctrl.mode
    #[arg(long, value_name = "SIGNAL")]
    modes: Vec<String>,
    /// Draw circles among the paths: a group of positions with a radius, for example world.obstacles
    #[arg(long, value_name = "GROUP")]
    circles: Vec<String>,
    /// Draw points among the paths: a group of positions, for example path.route
    #[arg(long, value_name = "GROUP")]
    points: Vec<String>,
    /// Draw cells on the ground: an array of Booleans, reals, or Integers of 32 bits each, for example map.occupied
    #[arg(long, value_name = "ARRAY")]
    raster: Vec<String>,
    /// The cells of a row of a raster, where no port `columns` is beside it
    #[arg(long, value_name = "COUNT")]
    raster_columns: Option<usize>,
    /// The side of a cell in metres, where no port `cell` is beside it
    #[arg(long, value_name = "METRES")]
    raster_cell: Option<f64>,
    /// Draw a surface of triangles: a Wavefront OBJ file in metres, or a group with point[…] and triangle[…]
    #[arg(long, value_name = "F.obj|GROUP")]
    mesh: Vec<String>,
    /// From where paths are seen: above or oblique [default: what fits]
    #[arg(long, value_name = "above|oblique", value_parser = view)]
    view: Option<ViewFrom>,
}

fn view(text: &str) -> Result<ViewFrom, String> {
    match text {
        "above" => Ok(ViewFrom::Above),
        "oblique" => Ok(ViewFrom::Oblique),
        _ => Err("expected above or oblique".to_owned()),
    }
}

/// A help that lists names lists at most this many.
const MOST_NAMES: usize = 60;

/// A message and its help.
type Refusal = (String, Option<String>);

impl Plot {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(self) -> u8 {
        match self.draw() {
            Ok((paths, partial)) => {
                if partial {
                    report::status("note: this run did not come to its end; the picture shows what was recorded");
                }
                paths.iter().for_each(|path| report::result(&format!("{}\n", printable::path(path))));
                0
            }
            Err((message, help)) => {
                report::error(&message, help.as_deref());
                2
            }
        }
    }

    /// Draws and writes the pictures; returns their paths, and whether the run did not come to its end.
    fn draw(&self) -> Result<(Vec<PathBuf>, bool), Refusal> {
        let files = self.files()?;
        let mut runs = vec![read(&self.run)?];
        let mut signals = Vec::new();
        for argument in &self.signals {
            // A column is meant where there is one; else what is a file or a folder is another run.
            let is_recorded = runs.iter().any(|run| run.has(argument));
            if !is_recorded && Path::new(argument).exists() {
                runs.push(read(Path::new(argument))?);
            } else {
                signals.push(argument.clone());
            }
        }
        let partial = runs.iter().any(|run| run.table.partial);
        let [names, groups] = [Run::names, Run::groups].map(|of| runs.first().map(of).unwrap_or_default());
        let selection = self.selection(signals)?;
        let refused = |error: PlotError| refusal(&error, &names, &groups);
        let drawing = draw(runs, &selection).map_err(refused)?;
        for file in &files {
            write(file, &drawing, self.scale).map_err(|error| match error {
                WriteError::Plot(error) => refused(error),
                WriteError::File(message) => (message, None),
            })?;
        }
        Ok((files, partial))
    }

    /// The pictures that are written.
    fn files(&self) -> Result<Vec<PathBuf>, Refusal> {
        let beside = if self.run.is_dir() { self.run.join(PLOT_SVG) } else { self.run.with_extension("svg") };
        let out = self.out.clone().unwrap_or(beside);
        let ending = out.extension().and_then(OsStr::to_str);
        if !matches!(ending, Some("svg" | "png")) {
            let message = format!("--out {} is no name of a picture", printable::path(&out));
            return Err((message, Some("pictures are SVG or PNG: let it end in .svg or .png".to_owned())));
        }
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            return Err(("--scale is above 0".to_owned(), None));
        }
        let png = (self.png && ending == Some("svg")).then(|| out.with_extension("png"));
        Ok([out].into_iter().chain(png).collect())
    }

    fn selection(&self, signals: Vec<String>) -> Result<Selection, Refusal> {
        let (columns, cell_m) = (self.raster_columns, self.raster_cell);
        let raster = |group: &String| Raster { group: group.clone(), columns, cell_m };
        let mut meshes = Vec::new();
        for name in &self.mesh {
            let path = PathBuf::from(name);
            let is_file = path.extension() == Some(OsStr::new("obj")) || path.is_file();
            meshes.push(if is_file {
                let text = fs::read_to_string(&path)
                    .map_err(|error| (format!("cannot read {}: {error}", printable::path(&path)), None))?;
                Mesh::Obj(path, text)
            } else {
                Mesh::Ports(name.clone())
            });
        }
        Ok(Selection {
            signals,
            mark: self.mark.clone(),
            modes: self.modes.clone(),
            circles: self.circles.clone(),
            points: self.points.clone(),
            rasters: self.raster.iter().map(raster).collect(),
            meshes,
            from_s: self.from,
            to_s: self.to,
            view: self.view.unwrap_or_default(),
            width: self.width,
        })
    }
}

fn read(path: &Path) -> Result<Run, Refusal> {
    Run::read(path).map_err(|error| {
        let help = "name the folder that `lockstep run` said, for example runs/first_flight";
        let help = error.help.clone().unwrap_or_else(|| help.to_owned());
        (error.to_string(), Some(help))
    })
}

enum WriteError {
    Plot(PlotError),
    File(String),
}

fn write(path: &Path, drawing: &Drawing, scale: f64) -> Result<(), WriteError> {
    let bytes = match path.extension() {
        Some(ending) if ending == "png" => drawing.png(scale).map_err(WriteError::Plot)?,
        _ => drawing.svg().into_bytes(),
    };
    fs::write(path, bytes).map_err(|error| WriteError::File(format!("cannot write {}: {error}", printable::path(path))))
}

/// An error with the name that was probably meant, and what there is.
fn refusal(error: &PlotError, names: &[String], groups: &[String]) -> Refusal {
    match error {
        PlotError::Unknown(name) => {
            let near = nearest(name, names.iter().chain(groups).map(String::as_str));
            let message = near.map_or_else(|| error.to_string(), |near| format!("{error}; did you mean `{near}`?"));
            let more = names.len().saturating_sub(MOST_NAMES);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            (message, Some(format!("recorded are: {}{more}", names[..names.len().min(MOST_NAMES)].join(", "))))
        }
        _ => (error.to_string(), None),
    }
}
