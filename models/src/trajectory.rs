//! The flight A…H of Geng & Chulin (2016), fig. 4: take-off, straight legs, two half circles, landing.
//!
//! ```text
//! AB, landing   z = z₀ + Δz (10 τ³ - 15 τ⁴ + 6 τ⁵),  τ = t / T          rest to rest, no jump of acceleration
//! straight      s = v₀ t + ½ a t²
//! half circle   r = R (sin φ, ±(1 - cos φ)),  φ = v t / R              sign: + to the left, - to the right
//! ```
//!
//! | Leg | What                                | Duration  | Ends by default at | Scales with          |
//! |-----|-------------------------------------|-----------|--------------------|----------------------|
//! | 1   | A→B climbs to `height_m`            | 12 s      | (0, 0, 10)         | height               |
//! | 2   | B→C speeds up to 2/5 v, then holds  | 2 + 14 s  | (30, 0, 10)        | v                    |
//! | 3   | C→D speeds up to v                  | 6 s       | (51, 0, 10)        | v                    |
//! | 4   | D→E half circle to the right        | π R₁ / v  | (51, -40, 10)      | R₁                   |
//! | 5   | E→F straight back                   | 6 s       | (21, -40, 10)      | v                    |
//! | 6   | F→G half circle to the left         | π R₂ / v  | (21, -70, 10)      | R₂                   |
//! | 7   | G→H brakes, descends, rests         | 5 + 14 + 3 s | (33.5, -70, 0)  | v, height            |
//!
//! | Symbol  | Here              | Unit | Meaning                                   |
//! |---------|-------------------|------|-------------------------------------------|
//! | v       | `speed_m_s`       | m/s  | on the circles                            |
//! | R₁, R₂  | `radius1_m`, …    | m    | of the circles                            |
//! | A       | `origin_m`        | m    | start of the flight                       |
//!
//! Frame: world. The paper gives the kinds of the legs and a figure; the numbers are this project's. Durations of the
//! straight and vertical legs are fixed: another speed changes accelerations and lengths in proportion, another height
//! the rates of climb. Position and velocity are continuous, acceleration is not at the ends of straights and circles.
//! The heading is always along x. With the defaults the flight takes 83.99 s. Source: Geng & Chulin (2016), fig. 4.

use core::f64::consts::PI;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::vehicle::Setpoint;

/// Size, origin and speed of the flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Height of the flight above its origin.
    pub height_m: f64,
    /// Speed on the circles and on the straight between them.
    pub speed_m_s: f64,
    /// Radius of the first half circle, to the right.
    pub radius1_m: f64,
    /// Radius of the second half circle, to the left.
    pub radius2_m: f64,
    /// Point A.
    pub origin_m: Vector3<f64>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self { height_m: 10.0, speed_m_s: 5.0, radius1_m: 20.0, radius2_m: 15.0, origin_m: Vector3::zeros() }
    }
}

/// The reference at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Setpoint of the vehicle.
    pub setpoint: Setpoint,
    /// Leg from 1 (A→B) to 7 (G→H, including the rest after landing).
    pub leg: i32,
    /// Whether the whole flight is over.
    pub finished: bool,
}

/// A part of the flight with one law of motion.
#[derive(Debug, Clone, Copy)]
enum Piece {
    /// Climb by this height from rest to rest.
    Vertical { rise_m: f64 },
    /// Straight along the present course.
    Straight { speed_m_s: f64, acceleration_m_s2: f64 },
    /// Half a circle; `side` is 1 to the left and -1 to the right.
    HalfCircle { radius_m: f64, speed_m_s: f64, side: f64 },
}

/// Position relative to the start of a piece, velocity, acceleration.
type Motion = [Vector3<f64>; 3];

impl Piece {
    /// Motion `time_s` into a piece of `duration_s`; `course` is 1 along x and -1 against it.
    fn motion(self, course: f64, time_s: f64, duration_s: f64) -> Motion {
        match self {
            Self::Vertical { rise_m } => {
                rest_to_rest(time_s / duration_s, duration_s).map(|along| Vector3::new(0.0, 0.0, along * rise_m))
            }
            Self::Straight { speed_m_s: v, acceleration_m_s2: a } => {
                [v * time_s + 0.5 * a * time_s * time_s, v + a * time_s, a]
                    .map(|along| Vector3::new(course * along, 0.0, 0.0))
            }
            Self::HalfCircle { radius_m, speed_m_s, side } => {
                let (sin, cos) = libm::sincos(speed_m_s * time_s / radius_m);
                let turn = course * side;
                let centripetal_m_s2 = speed_m_s * speed_m_s / radius_m;
                [
                    Vector3::new(course * sin, turn * (1.0 - cos), 0.0) * radius_m,
                    Vector3::new(course * cos, turn * sin, 0.0) * speed_m_s,
                    Vector3::new(-course * sin, turn * cos, 0.0) * centripetal_m_s2,
                ]
            }
        }
    }

    /// Displacement from start to end, and whether the course is reversed.
    fn whole(self, course: f64, duration_s: f64) -> (Vector3<f64>, bool) {
        match self {
            Self::HalfCircle { radius_m, side, .. } => (Vector3::new(0.0, course * side * 2.0 * radius_m, 0.0), true),
            _ => (self.motion(course, duration_s, duration_s)[0], false),
        }
    }
}

/// Quintic from 0 to 1 over `duration_s` at the fraction `tau` of it: value, rate per s, acceleration per s².
fn rest_to_rest(tau: f64, duration_s: f64) -> [f64; 3] {
    let (tau2, tau3) = (tau * tau, tau * tau * tau);
    [
        tau3 * (10.0 - 15.0 * tau + 6.0 * tau2),
        30.0 * tau2 * (1.0 - 2.0 * tau + tau2) / duration_s,
        60.0 * tau * (1.0 - 3.0 * tau + 2.0 * tau2) / (duration_s * duration_s),
    ]
}

impl Parameters {
    /// The pieces in order: leg, duration, law.
    fn pieces(&self) -> [(i32, f64, Piece); 10] {
        let v = self.speed_m_s;
        let cruise = 0.4 * v;
        let straight = |speed_m_s: f64, acceleration_m_s2: f64| Piece::Straight { speed_m_s, acceleration_m_s2 };
        let half_circle =
            |radius_m: f64, side: f64| (PI * radius_m / v, Piece::HalfCircle { radius_m, speed_m_s: v, side });
        let (first_s, first) = half_circle(self.radius1_m, -1.0);
        let (second_s, second) = half_circle(self.radius2_m, 1.0);
        [
            (1, 12.0, Piece::Vertical { rise_m: self.height_m }),
            (2, 2.0, straight(0.0, cruise / 2.0)),
            (2, 14.0, straight(cruise, 0.0)),
            (3, 6.0, straight(cruise, (v - cruise) / 6.0)),
            (4, first_s, first),
            (5, 6.0, straight(v, 0.0)),
            (6, second_s, second),
            (7, 5.0, straight(v, -v / 5.0)),
            (7, 14.0, Piece::Vertical { rise_m: -self.height_m }),
            (7, 3.0, straight(0.0, 0.0)),
        ]
    }

    /// Returns how long the flight takes in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.pieces().iter().map(|(_, duration_s, _)| duration_s).sum()
    }

    /// Returns the reference `time_s` after the start of the flight; it is A before the start and H after the end.
    #[must_use]
    pub fn reference(&self, time_s: f64) -> Reference {
        let mut left_s = time_s.max(0.0);
        let mut start_m = self.origin_m;
        let mut course = 1.0;
        for (leg, duration_s, piece) in self.pieces() {
            if left_s < duration_s {
                let [way_m, velocity_m_s, acceleration_m_s2] = piece.motion(course, left_s, duration_s);
                let position_m = start_m + way_m;
                let setpoint = Setpoint { position_m, velocity_m_s, acceleration_m_s2, yaw_rad: 0.0 };
                return Reference { setpoint, leg, finished: false };
            }
            left_s -= duration_s;
            let (way_m, turned_round) = piece.whole(course, duration_s);
            start_m += way_m;
            if turned_round {
                course = -course;
            }
        }
        Reference { setpoint: Setpoint::hold(start_m), leg: 7, finished: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time_s: f64) -> Reference {
        Parameters::default().reference(time_s)
    }

    /// Ends of the legs 1 to 7 in s.
    fn leg_ends_s() -> [f64; 7] {
        let mut ends = [0.0; 7];
        for (leg, duration_s, _) in Parameters::default().pieces() {
            for end in &mut ends[leg as usize - 1..] {
                *end += duration_s;
            }
        }
        ends
    }

    #[test]
    fn the_flight_takes_84_seconds() {
        assert!((Parameters::default().duration_s() - 83.99).abs() < 0.005);
        assert!(!at(83.98).finished && at(84.0).finished);
    }

    #[test]
    fn every_leg_ends_at_its_point_with_its_velocity() {
        let points = [
            ([0.0, 0.0, 10.0], 0.0),
            ([30.0, 0.0, 10.0], 2.0),
            ([51.0, 0.0, 10.0], 5.0),
            ([51.0, -40.0, 10.0], -5.0),
            ([21.0, -40.0, 10.0], -5.0),
            ([21.0, -70.0, 10.0], 5.0),
            ([33.5, -70.0, 0.0], 0.0),
        ];
        for (end_s, (point, speed)) in leg_ends_s().into_iter().zip(points) {
            let Setpoint { position_m, velocity_m_s, .. } = at(end_s + 1e-9).setpoint;
            assert!((position_m - Vector3::from(point)).norm() < 1e-7, "{position_m} at {end_s} s");
            assert!((velocity_m_s - Vector3::new(speed, 0.0, 0.0)).norm() < 1e-7, "{velocity_m_s} at {end_s} s");
        }
    }

    #[test]
    fn legs_count_from_1_to_7() {
        for (index, end_s) in leg_ends_s().into_iter().enumerate() {
            assert_eq!(at(end_s - 1e-6).leg, index as i32 + 1);
        }
    }

    #[test]
    fn position_and_velocity_are_continuous_and_each_quantity_is_the_derivative_of_the_one_before() {
        let h = 1e-4;
        for n in 1..839_900 / 7 {
            let time_s = f64::from(n) * 7.0 * h;
            let (before, here, after) = (at(time_s - h).setpoint, at(time_s).setpoint, at(time_s + h).setpoint);
            let velocity = (after.position_m - before.position_m) / (2.0 * h);
            assert!((velocity - here.velocity_m_s).norm() < 1e-4, "position jumps at {time_s} s");
            let jump = (after.velocity_m_s - before.velocity_m_s).norm();
            assert!(jump < 2.0 * h * 2.0, "velocity jumps by {jump} at {time_s} s");
            let piece_goes_on = (before.acceleration_m_s2 - after.acceleration_m_s2).norm() < 1e-3;
            let acceleration = (after.velocity_m_s - before.velocity_m_s) / (2.0 * h);
            let wrong = (acceleration - here.acceleration_m_s2).norm() > 1e-4;
            assert!(!(piece_goes_on && wrong), "acceleration is wrong at {time_s} s");
        }
    }

    #[test]
    fn circles_need_centripetal_acceleration_towards_their_centres() {
        let ends = leg_ends_s();
        let circles = [(ends[2], ends[3], [51.0, -20.0, 10.0], 20.0), (ends[4], ends[5], [21.0, -55.0, 10.0], 15.0)];
        for (from_s, to_s, centre, radius) in circles {
            for part in [0.1, 0.5, 0.9] {
                let here = at(from_s + part * (to_s - from_s)).setpoint;
                let to_centre_m = Vector3::from(centre) - here.position_m;
                assert!((to_centre_m.norm() - radius).abs() < 1e-9);
                assert!((here.acceleration_m_s2 - to_centre_m * 25.0 / (radius * radius)).norm() < 1e-9);
                assert!((here.velocity_m_s.norm() - 5.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_origin_moves_the_flight_and_the_speed_scales_its_straights() {
        let origin_m = Vector3::new(5.0, 6.0, 7.0);
        let moved = Parameters { origin_m, ..Parameters::default() };
        assert!((moved.reference(40.0).setpoint.position_m - origin_m - at(40.0).setpoint.position_m).norm() < 1e-12);
        let faster = Parameters { speed_m_s: 10.0, ..Parameters::default() };
        assert!((faster.reference(34.0).setpoint.position_m.x - 102.0).abs() < 1e-9);
    }
}
