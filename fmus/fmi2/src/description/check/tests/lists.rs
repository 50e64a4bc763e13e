//! Planted mistakes in unit definitions, type definitions and the model structure.

use super::planted;

#[test]
fn mistakes_in_unit_definitions_are_found() {
    insta::assert_snapshot!(planted(&[
        ("<Unit name=\"m\">", "<Unit>"),
        ("<Unit name=\"degC\">", "<Unit name=\"m/s\">"),
        ("<BaseUnit m=\"1\" s=\"-1\"/>", "<BaseUnit m=\"1\" s=\"-2\"/>"),
        ("<BaseUnit m=\"1\" s=\"-1\"/>", "<BaseUnit m=\"1\" s=\"-1\" factor=\"2\"/>"),
        ("<BaseUnit m=\"1\" s=\"-1\"/>", "<BaseUnit m=\"1\" s=\"-1\" factor=\"0\"/>"),
        ("<BaseUnit m=\"1\" s=\"-1\"/>", "<BaseUnit m=\"1\" s=\"-1\"/><BaseUnit/>"),
        ("<BaseUnit m=\"1\"/>", "<BaseUnit m=\"0.5\"/>"),
        ("<BaseUnit m=\"1\"/>", "<BaseUnit m=\"200\"/>"),
        ("offset=\"273.15\"", "offset=\"NaN\""),
        ("offset=\"273.15\"", "offset=\"0\""),
        ("factor=\"1000\"", "factor=\"0\""),
        ("<DisplayUnit name=\"mm\"", "<DisplayUnit"),
        ("<DisplayUnit ", "<DisplayUnit name=\"mm\"/><DisplayUnit "),
    ]));
}

#[test]
fn mistakes_in_type_definitions_are_found() {
    insta::assert_snapshot!(planted(&[
        ("SimpleType name=\"Count\"", "SimpleType name=\"Length\""),
        ("SimpleType name=\"Length\"", "SimpleType name=\"height\""),
        ("SimpleType name=\"Length\"", "SimpleType"),
        ("<Real unit=\"m\" min=\"0\" max=\"10\"/>", ""),
        ("<Real unit=\"m\" min=\"0\" max=\"10\"/>", "<Real/><Real/>"),
        ("<Real unit=\"m\" min=\"0\" max=\"10\"/>", "<Real unit=\"m\" min=\"9\" max=\"8\"/>"),
        ("<Real unit=\"m\" min=\"0\" max=\"10\"/>", "<Real unit=\"m\" min=\"0\" max=\"INF\"/>"),
        ("<Real unit=\"m\" min=\"0\" max=\"10\"/>", "<Real unit=\"m\" start=\"1\"/>"),
        ("<Integer min=\"0\" max=\"9\"/>", "<Integer min=\"5\" max=\"4\"/>"),
        ("name=\"on\" value=\"1\"", "name=\"on\" value=\"0\""),
        ("name=\"on\" value=\"1\"", "name=\"off\" value=\"1\""),
        ("name=\"on\" value=\"1\"", "value=\"1\""),
        ("name=\"on\" value=\"1\"", "name=\"on\""),
        ("<Item name=\"off\" value=\"0\"/>", "<Entry/>"),
    ]));
}

#[test]
fn an_enumeration_needs_an_item() {
    let items = "\n        <Item name=\"off\" value=\"0\"/>\n        <Item name=\"on\" value=\"1\"/>";
    insta::assert_snapshot!(planted(&[(items, "")]));
}

#[test]
fn mistakes_in_the_lists_of_the_structure_are_found() {
    insta::assert_snapshot!(planted(&[
        ("      <Unknown index=\"7\" dependencies=\"\"/>\n", ""),
        ("<Unknown index=\"7\" dependencies=\"\"/>", "<Unknown index=\"6\"/>"),
        ("<Unknown index=\"7\" dependencies=\"\"/>", "<Unknown index=\"0\"/>"),
        ("<Unknown index=\"7\" dependencies=\"\"/>", "<Unknown index=\"16\"/>"),
        ("<Unknown index=\"7\" dependencies=\"\"/>", "<Unknown/>"),
        ("<Unknown index=\"11\" dependencies=\"\"/>", "<Unknown index=\"11\"/><Unknown index=\"11\"/>"),
        ("<Unknown index=\"8\" dependencies=\"2\"/>\n    </Derivatives>", "<Unknown index=\"7\"/></Derivatives>"),
        ("      <Unknown index=\"6\" dependencies=\"4\"/>\n", ""),
        ("<Unknown index=\"6\" dependencies=\"4\"/>", "<Unknown index=\"6\"/><Unknown index=\"7\"/>"),
        ("<Unknown index=\"6\" dependencies=\"4\"/>", "<Unknown index=\"6\"/><Unknown index=\"6\"/>"),
        (
            "      <Unknown index=\"8\" dependencies=\"2\"/>\n      <Unknown index=\"9\"/>",
            "<Unknown index=\"9\"/><Unknown index=\"8\"/>"
        ),
        ("      <Unknown index=\"8\" dependencies=\"2\"/>\n      <Unknown index=\"9\"/>", ""),
        ("<Derivatives>", "<States/><Derivatives>"),
        ("<Outputs>", "<Outputs/><Outputs>"),
    ]));
}

#[test]
fn mistakes_in_dependencies_are_found() {
    let spill = "dependencies=\"2 7\" dependenciesKind=\"constant dependent\"";
    insta::assert_snapshot!(planted(&[
        (spill, "dependencies=\"7 2\""),
        (spill, "dependencies=\"2 2\""),
        (spill, "dependencies=\"0 2\""),
        (spill, "dependencies=\"2 99\""),
        (spill, "dependencies=\"2, 7\""),
        (spill, "dependencies=\"2 4\""),
        (spill, "dependencies=\"2 7\" dependenciesKind=\"constant\""),
        (spill, "dependencies=\"2 7\" dependenciesKind=\"constant linear\""),
        (spill, "dependenciesKind=\"constant\""),
        (spill, "dependencies=\"3\" dependenciesKind=\"constant\""),
        ("index=\"6\" dependencies=\"4\"", "index=\"6\" dependencies=\"4\" dependenciesKind=\"fixed\""),
        ("index=\"6\" dependencies=\"4\"", "index=\"6\" dependencies=\"9\""),
    ]));
}
