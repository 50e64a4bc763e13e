//! Tests of units of measure: the table against independent constants, the grammar, and the messages.

use std::f64::consts::PI;

use super::*;

fn dimension(text: &str) -> String {
    parse(text).unwrap().dimension.to_string()
}

#[test]
fn factors_are_the_nearest_floats_to_the_exact_decimals() {
    let expected = [
        ("m", 1.0),
        ("kg", 1.0),
        ("g", 1e-3),
        ("mg", 1e-6),
        ("ug", 1e-9),
        ("t", 1e3),
        ("nm", 1e-9),
        ("um", 1e-6),
        ("µm", 1e-6),
        ("mm", 1e-3),
        ("cm", 1e-2),
        ("km", 1e3),
        ("MW", 1e6),
        ("GHz", 1e9),
        ("ms", 1e-3),
        ("min", 60.0),
        ("h", 3600.0),
        ("d", 86_400.0),
        ("L", 1e-3),
        ("mL", 1e-6),
        ("bar", 1e5),
        ("mbar", 100.0),
        ("%", 0.01),
        ("ft", 0.3048),
        ("in", 0.0254),
        ("nmi", 1852.0),
        ("kn", 1852.0 / 3600.0),
        ("deg", PI / 180.0),
        ("°", PI / 180.0),
        ("rpm", PI / 30.0),
        ("km/h", 1.0 / 3.6),
        ("L/min", 1.0 / 60_000.0),
        ("mm^3", 1e-9),
        ("g/cm3", 1e3),
    ];
    for (text, factor) in expected {
        assert_eq!(parse(text).unwrap().factor.to_bits(), f64::to_bits(factor), "{text}");
    }
}

#[test]
fn dimensions_are_written_with_one_fraction_bar() {
    let expected = [
        ("1", "1"),
        ("%", "1"),
        ("1/s", "1/s"),
        ("N", "kg m/s^2"),
        ("N.m", "kg m^2/s^2"),
        ("N*m", "kg m^2/s^2"),
        ("Pa", "kg/(m s^2)"),
        ("kg.m2", "kg m^2"),
        ("m3/s", "m^3/s"),
        ("m/s^2", "m/s^2"),
        ("m/s²", "m/s^2"),
        ("m.s-2", "m/s^2"),
        ("m*s^-2", "m/s^2"),
        ("m³", "m^3"),
        ("m/s/s", "m/s^2"),
        ("rad/s", "rad/s"),
        ("rpm", "rad/s"),
        ("V", "kg m^2/(s^3 A)"),
        ("F", "s^4 A^2/(kg m^2)"),
        ("lx", "cd rad^2/m^2"),
        ("kat", "mol/s"),
        ("cd", "cd"),
    ];
    for (text, written) in expected {
        assert_eq!(dimension(text), written, "{text}");
    }
}

#[test]
fn derived_units_agree_with_their_definitions() {
    let same = [
        ("N", "kg*m/s2"),
        ("Pa", "N/m2"),
        ("J", "N*m"),
        ("W", "J/s"),
        ("V", "W/A"),
        ("C", "A*s"),
        ("F", "C/V"),
        ("Ohm", "V/A"),
        ("Ω", "Ohm"),
        ("S", "1/Ohm"),
        ("Wb", "V*s"),
        ("T", "Wb/m2"),
        ("H", "Wb/A"),
        ("sr", "rad2"),
        ("lm", "cd*sr"),
        ("lx", "lm/m2"),
        ("Gy", "J/kg"),
        ("Sv", "Gy"),
        ("Bq", "Hz"),
        ("kat", "mol/s"),
        ("°C", "degC"),
    ];
    for (left, right) in same {
        assert_eq!(parse(left).unwrap(), parse(right).unwrap(), "{left} and {right}");
    }
}

#[test]
fn an_unknown_unit_is_named_with_a_suggestion() {
    let mut shown = String::new();
    let wrong = [
        "", "m/", "/s", "m//s", "m/s*k", "Nm", "kWh", "sec", "deg/sec", "Meter", "feet", "knots", "hz", "KG", "Kg",
        "percent", "mdeg", "hPa", "m s", "m^", "m^x", "m2.5/s", "degC/s", "degC2", "°C.m", "m200", "m127*m", "2m",
        "xyz", "1m", "€", "(m)",
    ];
    for text in wrong {
        let unknown = parse(text).unwrap_err();
        shown += &format!("{text:10} {unknown}\n");
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn a_celsius_scale_has_an_offset_and_is_not_allowed_in_expressions() {
    let celsius = parse("degC").unwrap();
    assert_eq!((celsius.to_si(-5.0), celsius.from_si(268.15)), (268.15, -5.0));
    let kelvin = parse("K").unwrap();
    assert_eq!(kelvin.conversion_to(&celsius), Some(Conversion { factor: 1.0, offset: -273.15 }));
}

#[test]
fn an_si_unit_keeps_the_bits_of_a_value() {
    let meter = parse("m").unwrap();
    for value in [-0.0, 0.0, 0.1, f64::MIN_POSITIVE / 3.0, f64::NEG_INFINITY, f64::from_bits(0x7ff8_0000_0000_1234)] {
        assert_eq!(meter.to_si(value).to_bits(), value.to_bits());
        assert_eq!(meter.from_si(value).to_bits(), value.to_bits());
        assert_eq!(Conversion::IDENTITY.apply(value).to_bits(), value.to_bits());
    }
}

#[test]
fn units_of_different_dimension_do_not_convert() {
    let (meter, second, foot) = (parse("m").unwrap(), parse("s").unwrap(), parse("ft").unwrap());
    assert_eq!(meter.conversion_to(&second), None);
    assert_eq!(foot.conversion_to(&meter).map(|conversion| conversion.apply(10.0)), Some(3.048));
    assert_eq!(foot.conversion_to(&foot), Some(Conversion::IDENTITY));
}

#[test]
fn dimensions_multiply_divide_and_take_powers_within_their_range() {
    let (speed, time) = (parse("m/s").unwrap().dimension, parse("s").unwrap().dimension);
    assert_eq!(speed.checked_mul(time), Some(parse("m").unwrap().dimension));
    assert_eq!(speed.checked_div(time), Some(parse("m/s2").unwrap().dimension));
    assert_eq!(speed.checked_pow(2), Some(parse("Sv").unwrap().dimension));
    assert_eq!(speed.checked_pow(2).and_then(Dimension::checked_sqrt), Some(speed));
    assert_eq!(speed.checked_sqrt(), None);
    let far = Dimension([127, 0, 0, 0, 0, 0, 0, 0]);
    let kilogram = parse("kg").unwrap().dimension;
    assert_eq!((far.checked_mul(kilogram), far.checked_pow(2)), (None, None));
    assert_eq!(Dimension([-128, 0, 0, 0, 0, 0, 0, 0]).checked_div(kilogram), None);
    assert_eq!(parse("rad/s").unwrap().dimension.without_angle(), parse("Hz").unwrap().dimension);
}

proptest::proptest! {
    #[test]
    fn no_text_causes_a_panic_of_the_parser(text in "[a-zA-Z0-9°%²³^*/. \\-µ€]{0,12}") {
        if let Err(unknown) = parse(&text) {
            proptest::prop_assert!(text.get(unknown.part.clone()).is_some(), "{unknown}");
        }
    }
}

#[test]
fn parts_of_an_si_unit_are_converted_by_whole_numbers() {
    let of = |factor: f64| BaseUnit { factor, ..BaseUnit::default() };
    for number in 1..10_000 {
        let number = f64::from(number);
        assert_eq!(of(0.001).to_si(number), number / 1000.0);
        assert_eq!(of(0.001).from_si(number / 7.0), number / 7.0 * 1000.0);
        assert_eq!(of(60.0).to_si(number), number * 60.0);
    }
    assert_eq!(of(0.001).to_si(700.0), 0.7);
    assert_eq!(
        [0.001, 0.01, 1.0, 60.0, 1.0 / 3.6].map(|factor| of(factor).parts()),
        [Some(1000.0), Some(100.0), None, None, None]
    );
    assert_eq!(BaseUnit { offset: 1.0, ..of(0.001) }.parts(), None);
}
