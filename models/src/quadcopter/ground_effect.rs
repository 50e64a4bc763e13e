//! Ground effect: the increase of a rotor's thrust near the ground.
//!
//! ```text
//! r_g = 1 / (1 - (R/4h)² / (1 + (V/w_d)²))        Geng & Chulin (2016), eq. 4; Cheeseman & Bennett (1955)
//! ```
//!
//! | Symbol | Here            | Unit | Meaning                                                       |
//! |--------|-----------------|------|---------------------------------------------------------------|
//! | r_g    | returned        | 1    | thrust with the ground divided by thrust without              |
//! | h      | `hub_height_m`  | m    | height of the rotor's hub above the ground                    |
//! | R      | `radius_m`      | m    | radius of the rotor                                           |
//! | V      | `speed_m_s`     | m/s  | speed of the vehicle over the ground                          |
//! | w_d    | `induced_m_s`   | m/s  | induced velocity of the rotor, at least 0.1 m/s               |
//!
//! Valid above h = R/2. Departures from print: the text defines the ratio inverted, and eq. 5 adds the whole ratio,
//! which doubles the thrust far from the ground; here it multiplies the thrust. The formula is singular at h = R/4,
//! so h is limited to at least R/2 and the ratio to at most 4/3; from 2 m upwards it is 1.

const OUT_OF_REACH_M: f64 = 2.0;
const LARGEST_RATIO: f64 = 4.0 / 3.0;
const LEAST_INDUCED_M_S: f64 = 0.1;

/// Returns the thrust with the ground divided by the thrust without it.
pub fn ratio(radius_m: f64, hub_height_m: f64, speed_m_s: f64, induced_m_s: f64) -> f64 {
    if hub_height_m >= OUT_OF_REACH_M {
        return 1.0;
    }
    let closeness = radius_m / (4.0 * hub_height_m.max(radius_m / 2.0));
    let advance = speed_m_s / induced_m_s.max(LEAST_INDUCED_M_S);
    (1.0 / (1.0 - closeness * closeness / (1.0 + advance * advance))).min(LARGEST_RATIO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::{assert_close, get, number};

    #[test]
    fn the_ratio_equals_that_of_the_vectors() {
        for row in get("ge_ratio").as_array().unwrap() {
            let actual = ratio(0.15, number(&row["h"]), number(&row["V"]), number(&row["vi"]));
            assert_close(actual, number(&row["ratio"]), 1e-8);
        }
    }

    #[test]
    fn far_from_the_ground_there_is_no_effect() {
        assert_eq!(ratio(0.15, 2.0, 0.0, 3.0), 1.0);
    }

    #[test]
    fn forward_speed_reduces_the_ground_effect() {
        assert!(ratio(0.15, 0.2, 8.0, 3.0) < ratio(0.15, 0.2, 2.0, 3.0));
    }
}
