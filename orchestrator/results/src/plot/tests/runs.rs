//! Runs as tests draw them: tables with claims and windows.

use super::super::run::{Claim, Run, Window};
use crate::comparison::{Comparison, Operation, Quantity};
use crate::table::{Column, Table};

/// A run of 201 rows over 20 s; columns are added by functions of time.
pub(super) fn run(name: &str, title: &str) -> Run {
    let time = Column { name: "time".to_owned(), unit: Some("s".to_owned()), ..Column::default() };
    let time = Column { values: (0..=200).map(|row| Some(f64::from(row) / 10.0)).collect(), ..time };
    Run {
        name: name.to_owned(),
        title: title.to_owned(),
        end: "stop time".to_owned(),
        table: Table { columns: vec![time], partial: false },
        ..Run::default()
    }
}

impl Run {
    pub(super) fn with(mut self, name: &str, unit: &str, value: impl Fn(f64) -> f64) -> Self {
        let values = self.table.time_s().into_iter().map(|time_s| Some(value(time_s))).collect();
        let unit = Some(unit.to_owned()).filter(|unit| !unit.is_empty());
        self.table.columns.push(Column { name: name.to_owned(), unit, values, ..Column::default() });
        self
    }

    /// The last column is no Real.
    pub(super) fn of_kind(mut self, kind: &str, items: &[(i32, &str)]) -> Self {
        let column = self.table.columns.last_mut().unwrap();
        column.kind = kind.to_owned();
        column.is_discrete = true;
        column.items = items.iter().map(|(value, name)| (*value, (*name).to_owned())).collect();
        self
    }

    pub(super) fn along(self, group: &str, at: impl Fn(f64) -> [f64; 3]) -> Self {
        let axis =
            |run: Self, axis: usize| run.with(&format!("{group}.{}", ["x", "y", "z"][axis]), "m", |t| at(t)[axis]);
        (0..3).fold(self, axis)
    }

    pub(super) fn claim(
        mut self,
        name: &str,
        verdict: &str,
        times: (Option<f64>, f64),
        comparisons: &[Comparison],
    ) -> Self {
        self.claims.push(Claim {
            name: name.to_owned(),
            verdict: verdict.to_owned(),
            first_s: times.0,
            at_s: Some(times.1),
            part: Some(0),
            signals: comparisons.iter().flat_map(|it| it.quantity.columns()).map(str::to_owned).collect(),
            comparisons: comparisons.to_vec(),
        });
        self
    }

    pub(super) fn window(mut self, text: &str, from_s: f64, to_s: Option<f64>) -> Self {
        self.windows.push(Window { from_s, to_s, text: text.to_owned() });
        self
    }
}

pub(super) fn column(name: &str) -> Quantity {
    Quantity::Column { column: name.to_owned() }
}

pub(super) fn comparison(quantity: Quantity, low: Option<f64>, high: Option<f64>) -> Comparison {
    Comparison {
        text: String::new(),
        part: 0,
        quantity,
        is_margin: false,
        unit: None,
        low,
        high,
        once: false,
        from_s: 0.0,
        to_s: None,
    }
}

/// The distance of two positions.
pub(super) fn distance(a: &str, b: &str) -> Quantity {
    let difference = |axis: &str| {
        Quantity::call(Operation::Subtract, vec![column(&format!("{a}.{axis}")), column(&format!("{b}.{axis}"))])
    };
    Quantity::call(Operation::Norm, ["x", "y", "z"].map(difference).to_vec())
}

/// A multicopter that stays where it is, but for a little noise.
pub(super) fn hover() -> Run {
    let noise = |t: f64| 1e-3 * ((7.0 * t) % 1.0 - 0.5);
    run("hover", "A quadcopter hovers")
        .along("quad.state.position", move |t| [noise(t), noise(t + 3.3), 10.0 + noise(t + 7.7)])
        .with("quad.roll", "rad", move |t| 0.1 * noise(t))
        .with("quad.pitch", "rad", move |t| 0.1 * noise(t + 1.7))
        .with("quad.contact", "", |_| 0.0)
        .of_kind("Boolean", &[])
        .with("quad.restarts", "", |_| 3.0)
        .of_kind("Integer", &[])
        .claim("stays", "ok", (None, 7.0), &[comparison(column("quad.state.position.z"), Some(9.95), Some(10.05))])
}

/// A battery that runs down and is too low at the end.
pub(super) fn battery() -> Run {
    let level = |t: f64| 1.0 - 0.048 * t;
    run("battery", "A battery runs down")
        .with("battery.level", "", level)
        .with("battery.voltage", "V", move |t| 14.0 + 2.8 * level(t))
        .with("battery.current", "A", |t| if t % 5.0 < 2.5 { 18.0 } else { 26.0 })
        .claim("lasts", "failed", (Some(16.7), 20.0), &[comparison(column("battery.level"), Some(0.2), None)])
}

/// A mission with modes: an enumeration.
pub(super) fn mission() -> Run {
    let mode = |t: f64| f64::from(u8::from(t >= 3.0) + u8::from(t >= 9.0) + u8::from(t >= 14.0) + u8::from(t >= 18.5));
    run("mission", "A mission with modes")
        .with("nav.mode", "", move |t| mode(t) + 1.0)
        .of_kind("Enumeration", &[(1, "idle"), (2, "take_off"), (3, "cruise"), (4, "return_to_home"), (5, "landed")])
        .with("nav.height", "m", move |t| (t - 3.0).clamp(0.0, 6.0).min(20.0 - t) * 2.0)
        .with("nav.armed", "", |t| f64::from(u8::from((3.0..18.5).contains(&t))))
        .of_kind("Boolean", &[])
        .with("nav.retries", "", |t| (t / 6.0).floor())
        .of_kind("Integer", &[])
        .window("at 6 s: bias", 6.0, Some(8.0))
        .window("when nav.height > 11 m: set, freeze", 8.5, Some(8.6))
        .window("while nav.armed: noise", 3.0, None)
}

/// Two vehicles around obstacles that come too near once.
pub(super) fn two_vehicles() -> Run {
    let together = Comparison {
        text: "dist(wing[1].state.position, wing[2].state.position) < 9 m".to_owned(),
        unit: Some("m".to_owned()),
        ..comparison(distance("wing[1].state.position", "wing[2].state.position"), None, Some(9.0))
    };
    let run = run("two", "Two vehicles pass obstacles")
        .along("wing[1].state.position", |t| [4.0 * t, 10.0 * libm::sin(t / 4.0), 12.0])
        .along("wing[2].state.position", |t| [4.0 * t, 10.0 * libm::sin(t / 4.0) - 8.0 - 0.1 * t, 12.0 + 0.2 * t])
        .claim("together", "failed", (Some(8.0), 20.0), &[together]);
    let run = run.with("world.obstacles.count", "", |_| 2.0).of_kind("Integer", &[]);
    let run = (1..=3).fold(run, |run, index| {
        let at = f64::from(index);
        run.along(&format!("world.obstacles.position[{index}]"), move |t| [20.0 * at, -4.0 + 0.3 * t * (at - 1.0), 6.0])
            .along(&format!("world.obstacles.velocity[{index}]"), |_| [0.0; 3])
    });
    (1..=3).fold(run, |run, index| {
        run.with(&format!("world.obstacles.radius[{index}]"), "m", move |_| 2.0 + f64::from(index)).with(
            &format!("world.obstacles.height[{index}]"),
            "m",
            |_| 12.0,
        )
    })
}
