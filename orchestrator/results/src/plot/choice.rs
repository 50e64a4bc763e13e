//! Which signals a picture shows: those that were asked for, or else paths, what the claims are about, and a few more.

use super::claimed::{self, Limit};
use super::run::Run;
use super::trace::{Kind, Samples, display_unit, group_of, without_indices};
use super::{PlotError, Selection};
use crate::comparison::Comparison;
use std::collections::{BTreeMap, BTreeSet};

/// Without a choice of signals a picture has at most this many panels of what no claim is about, less those of claims.
const DEFAULT_PANELS: usize = 4;
/// And at most this many in all.
const MOST_PANELS: usize = 8;
/// A panel that was not asked for has at most this many curves.
const MOST_CURVES: usize = 6;

/// What a picture shows.
#[derive(Debug, Default)]
pub(super) struct Choice {
    /// Position groups; the first is the main one.
    pub paths: Vec<String>,
    pub panels: Vec<Panel>,
    /// How many of the recorded columns are drawn, of how many.
    pub shown: (usize, usize),
}

/// What one panel shows.
#[derive(Debug)]
pub(super) struct Panel {
    pub kind: Kind,
    pub unit: String,
    pub curves: Vec<Curve>,
    pub limits: Vec<Limit>,
    /// The names of an enumeration's values.
    pub items: BTreeMap<i32, String>,
}

/// One signal, with its samples in each run.
#[derive(Debug)]
pub(super) struct Curve {
    pub name: String,
    pub of_runs: Vec<Samples>,
}

/// What a panel is made of.
enum Spec<'a> {
    Columns(Vec<&'a str>),
    /// Comparisons of the first run's claims that are about the same: the indices of claim and comparison of each.
    Claimed(Vec<(usize, usize)>),
}

impl Choice {
    pub(super) fn new(runs: &[Run], selection: &Selection) -> Result<Self, PlotError> {
        let Some(first) = runs.first() else { return Err(PlotError::Empty) };
        let overlays = selection.circles.iter().chain(&selection.points);
        let overlays = overlays.chain(selection.rasters.iter().map(|raster| &raster.group));
        let overlays = overlays.flat_map(|group| first.members(group)).collect();
        let chooser = Chooser { runs, first, overlays };
        let (paths, specs) =
            if selection.signals.is_empty() { chooser.by_default() } else { chooser.chosen(&selection.signals)? };
        let mut columns: BTreeSet<String> = BTreeSet::new();
        for path in &paths {
            columns.extend(["x", "y", "z"].map(|axis| format!("{path}.{axis}")));
        }
        for spec in &specs {
            match spec {
                Spec::Columns(names) => columns.extend(names.iter().map(|name| (*name).to_owned())),
                Spec::Claimed(same) => columns
                    .extend(same.iter().flat_map(|at| chooser.comparison(*at).quantity.columns()).map(str::to_owned)),
            }
        }
        for name in selection.modes.iter().chain(&selection.mark) {
            if first.table.column(name).is_none() {
                return Err(PlotError::Unknown(name.clone()));
            }
            columns.insert(name.clone());
        }
        columns.extend(chooser.overlays.iter().map(|name| (*name).to_owned()));
        let recorded: BTreeSet<_> = first.table.names().skip(1).collect();
        let shown = columns.iter().filter(|name| recorded.contains(name.as_str())).count();
        let panels = specs.into_iter().map(|spec| chooser.panel(spec)).collect();
        Ok(Self { paths, panels, shown: (shown, recorded.len()) })
    }
}

struct Chooser<'a> {
    runs: &'a [Run],
    first: &'a Run,
    /// The columns that stand among the paths.
    overlays: BTreeSet<&'a str>,
}

impl<'a> Chooser<'a> {
    /// What may share a panel: columns of one group, unit and kind; an enumeration or a Boolean has one of its own.
    fn together(&self, a: &str, b: &str) -> bool {
        let alike = self.first.unit(a) == self.first.unit(b) && self.first.kind(a) == self.first.kind(b);
        alike && matches!(self.first.kind(a), Kind::Real | Kind::Integer)
    }

    fn chosen(&self, signals: &[String]) -> Result<(Vec<String>, Vec<Spec<'a>>), PlotError> {
        let (mut paths, mut specs) = (Vec::new(), Vec::new());
        for names in signals {
            let mut columns = Vec::new();
            for name in names.split(',') {
                let members = self.first.members(name);
                let claim = self.first.claims.iter().position(|claim| claim.name == name);
                match (self.first.path(name), members.is_empty(), claim) {
                    (Some(_), ..) => paths.push(name.to_owned()),
                    (None, false, _) => columns.extend(members),
                    (None, true, Some(claim)) => specs.extend(self.of_claim(claim)),
                    (None, true, None) => return Err(PlotError::Unknown(name.to_owned())),
                }
            }
            let panels = columns.chunk_by(|a, b| self.together(a, b));
            specs.extend(panels.map(|names| Spec::Columns(names.to_vec())));
        }
        Ok((paths, specs))
    }

    /// The panels that show what a claim is about.
    fn of_claim(&self, claim: usize) -> Vec<Spec<'a>> {
        let first: &'a Run = self.first;
        let comparisons = first.claims[claim].comparisons.iter().enumerate();
        let mut specs: Vec<Spec<'a>> = Vec::new();
        let mut add = |names: Vec<&'a str>| {
            let has =
                |spec: &Spec<'_>| matches!(spec, Spec::Columns(known) if known.iter().any(|name| names.contains(name)));
            if !names.is_empty() && !specs.iter().any(has) {
                specs.push(Spec::Columns(names));
            }
        };
        let mut derived = Vec::new();
        let mut covered: Vec<&str> = Vec::new();
        for (index, comparison) in comparisons {
            covered.extend(comparison.quantity.columns());
            match claimed::column_of(comparison).and_then(|name| first.table.column(name)) {
                Some(column) => add(self.around(&column.name)),
                None if comparison.quantity.columns().iter().all(|name| first.table.column(name).is_some()) => {
                    derived.push(Spec::Claimed(vec![(claim, index)]));
                }
                None => {}
            }
        }
        for name in &first.claims[claim].signals {
            if let Some(column) = first.table.column(name).filter(|_| !covered.contains(&name.as_str())) {
                add(self.around(&column.name));
            }
        }
        derived.extend(specs);
        derived
    }

    /// A column with those that share its panel.
    fn beside(&self, name: &'a str) -> Vec<&'a str> {
        let first: &'a Run = self.first;
        let in_group = |other: &str| group_of(other) == group_of(name) && group_of(name) != name;
        let is_alike = |other: &str| without_indices(other) == without_indices(name);
        let same = |other: &&str| *other == name || (in_group(other) || is_alike(other)) && self.together(other, name);
        let names: Vec<_> = first.table.names().skip(1).filter(same).collect();
        names.chunks(MOST_CURVES).find(|names| names.contains(&name)).map_or(vec![name], <[_]>::to_vec)
    }

    /// Whether two comparisons compare the same quantity in the same unit.
    fn is_about_the_same(&self, one: &Spec<'_>, other: &Spec<'_>) -> bool {
        let key = |spec: &Spec<'_>| match spec {
            Spec::Claimed(same) => same.first().map(|at| self.comparison(*at)).map(|it| (&it.quantity, &it.unit)),
            Spec::Columns(_) => None,
        };
        key(one).is_some() && key(one) == key(other)
    }

    /// The panel of a column that a claim limits. One coordinate of a position stands alone: what limits a height is small
    /// beside how far a vehicle goes.
    fn around(&self, name: &'a str) -> Vec<&'a str> {
        if self.first.path(group_of(name)).is_some() { vec![name] } else { self.beside(name) }
    }

    /// All position groups; what the claims are about; then the first groups of columns that are no positions.
    fn by_default(&self) -> (Vec<String>, Vec<Spec<'a>>) {
        let first: &'a Run = self.first;
        let groups = first.table.names().filter_map(|name| name.strip_suffix(".x")).filter(|g| g.ends_with("position"));
        let mut paths: Vec<_> = groups.filter(|group| first.path(group).is_some()).map(str::to_owned).collect();
        // Actual positions come before setpoints.
        paths.sort_by_key(|path| path.contains("setpoint"));
        let in_path = |name: &str| {
            paths.iter().any(|path| name.strip_prefix(path.as_str()).is_some_and(|rest| rest.starts_with('.')))
        };
        let mut specs: Vec<Spec<'a>> = Vec::new();
        let is_shown = |specs: &[Spec<'_>], names: &[&str]| {
            specs
                .iter()
                .any(|spec| matches!(spec, Spec::Columns(known) if names.iter().all(|name| known.contains(name))))
        };
        for claim in 0..first.claims.len() {
            for spec in self.of_claim(claim) {
                let equal = specs.iter().position(|known| self.is_about_the_same(known, &spec));
                match (spec, equal) {
                    (Spec::Columns(names), _) if is_shown(&specs, &names) => {}
                    (Spec::Claimed(more), Some(equal)) => {
                        if let Spec::Claimed(same) = &mut specs[equal] {
                            same.extend(more);
                        }
                    }
                    (spec, _) if specs.len() < MOST_PANELS => specs.push(spec),
                    _ => {}
                }
            }
        }
        // What changes comes before what stays as it is.
        let others = || first.table.names().skip(1).filter(|name| !in_path(name) && !self.overlays.contains(name));
        let (changing, constant): (Vec<_>, Vec<_>) = others().partition(|name| first.changes(name));
        for name in changing.into_iter().chain(constant) {
            if specs.len() >= DEFAULT_PANELS {
                break;
            }
            if !is_shown(&specs, &[name]) {
                specs.push(Spec::Columns(self.beside(name).into_iter().filter(|name| !in_path(name)).collect()));
            }
        }
        (paths, specs)
    }

    fn panel(&self, spec: Spec<'_>) -> Panel {
        match spec {
            Spec::Columns(names) => self.columns(&names),
            Spec::Claimed(same) => self.claimed(&same),
        }
    }

    fn columns(&self, names: &[&str]) -> Panel {
        let kind = names.first().map_or(Kind::Real, |name| self.first.kind(name));
        let unit = names.first().map(|name| self.first.unit(name)).unwrap_or_default();
        let (shown_unit, factor) = if kind == Kind::Real { display_unit(unit) } else { (unit, 1.0) };
        let of_run = |run: &Run, name: &str| {
            run.samples(name).into_iter().map(|(time_s, value)| (time_s, value * factor)).collect()
        };
        let curve = |name: &&str| Curve {
            name: (*name).to_owned(),
            of_runs: self.runs.iter().map(|run| of_run(run, name)).collect(),
        };
        let items = names.first().and_then(|name| self.first.table.column(name)).map(|column| column.items.clone());
        Panel {
            kind,
            unit: shown_unit.to_owned(),
            curves: names.iter().map(curve).collect(),
            limits: claimed::limits_of_columns(self.first, names, factor),
            items: items.unwrap_or_default(),
        }
    }

    fn comparison(&self, (claim, index): (usize, usize)) -> &'a Comparison {
        &self.first.claims[claim].comparisons[index]
    }

    fn claimed(&self, same: &[(usize, usize)]) -> Panel {
        let comparison = self.comparison(same[0]);
        let of_runs = self.runs.iter().map(|run| claimed::samples(run, &comparison.quantity));
        let curve = Curve { name: claimed::quantity_text(comparison), of_runs: of_runs.collect() };
        Panel {
            kind: Kind::Real,
            unit: comparison.unit.clone().unwrap_or_default(),
            curves: vec![curve],
            limits: same.iter().filter_map(|(claim, index)| claimed::limit(self.first, *claim, *index, 1.0)).collect(),
            items: BTreeMap::new(),
        }
    }
}
