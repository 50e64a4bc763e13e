//! The units of a script and their connections, for a picture.

use dsl::groups::without_shared_members;
use dsl::scenario::{Connection, Drive, Port, Scenario, duration};
use fmi2::description::{Kind, ModelDescription};
use fmi2::printable;
use results::graph::{Arrow, Graph, Node};

/// The graph of a script; `descriptions` are those of its instances.
#[must_use]
pub fn of(scenario: &Scenario, descriptions: &[&ModelDescription]) -> Graph {
    let nodes = scenario.instances.iter().map(|instance| Node {
        name: instance.name.clone(),
        unit: printable::line(&scenario.units[instance.unit].name),
        when: format!("wave {}, every {}", instance.wave, duration(instance.every * scenario.step_ns)),
        wave: instance.wave,
    });
    let mut graph = Graph { title: scenario.title.clone(), nodes: nodes.collect(), arrows: Vec::new() };
    for connection in &scenario.connections {
        for arrow in arrows(scenario, descriptions, connection) {
            let is_same = |known: &&mut Arrow| {
                (known.from, known.to, known.direct) == (arrow.from, arrow.to, arrow.direct)
                    && (&known.source, &known.target) == (&arrow.source, &arrow.target)
            };
            match graph.arrows.iter_mut().find(is_same) {
                Some(known) => {
                    let new = arrow.measures.into_iter().filter(|measure| !known.measures.contains(measure));
                    known.measures.extend(new.collect::<Vec<_>>());
                }
                None => graph.arrows.push(arrow),
            }
        }
    }
    graph
}

/// One arrow from each instance that a connection reads.
fn arrows(scenario: &Scenario, descriptions: &[&ModelDescription], connection: &Connection) -> Vec<Arrow> {
    let mut sources: Vec<Port> = Vec::new();
    connection.source.reads(scenario.slots(), &mut |port| {
        if sources.iter().all(|known| known.instance != port.instance) {
            sources.push(port);
        }
    });
    let variable = |port: Port| &descriptions[port.instance].variables[port.variable];
    let target = variable(connection.target);
    let measure = match &target.kind {
        Kind::Real(_) => descriptions[connection.target.instance].unit_of(target).unwrap_or("no unit").to_owned(),
        Kind::Integer { .. } => "Integer".to_owned(),
        Kind::Boolean { .. } => "Boolean".to_owned(),
        Kind::String { .. } => "String".to_owned(),
        Kind::Enumeration { .. } => target.declared_type.clone().unwrap_or_else(|| "Enumeration".to_owned()),
    };
    let is_copy = matches!(connection.source, Drive::Copy(_));
    let arrow = |port: &Port| {
        let names = without_shared_members(&[variable(*port).name.as_str(), target.name.as_str()]);
        let [source, to] = [0, 1].map(|index| printable::line(names.get(index).map_or("", String::as_str)));
        Arrow {
            from: port.instance,
            to: connection.target.instance,
            source: if is_copy { source } else { format!("f({source})") },
            target: to,
            direct: connection.direct,
            measures: vec![printable::line(&measure)],
        }
    };
    sources.iter().map(arrow).collect()
}
