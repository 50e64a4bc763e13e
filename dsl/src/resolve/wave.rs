//! The order within one step: a unit steps after all whose results come to it over `=>`.

use std::collections::{BTreeMap, BTreeSet};

use super::scope::Scope;
use super::wire::Wired;
use crate::diagnostic::{Diagnostic, Edit};
use fmi2::description::Initial;

/// One unit waits for another because of a connection statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    from: usize,
    to: usize,
    wire: usize,
}

impl Scope<'_, '_> {
    /// The wave of each instance; `None` if some wait for each other.
    pub fn waves(&self, connections: &[Wired]) -> Option<Vec<usize>> {
        let edges: BTreeSet<Edge> = connections
            .iter()
            .filter(|wired| wired.connection.direct)
            .flat_map(|wired| {
                let to = wired.connection.target.instance;
                let ports = self.read_by(&wired.connection.source).into_iter();
                ports.map(move |port| Edge { from: port.instance, to, wire: wired.wire })
            })
            .collect();
        let mut waiting: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); self.script.instances.len()];
        let mut waits: Vec<BTreeSet<usize>> = waiting.clone();
        for edge in &edges {
            waits[edge.to].insert(edge.from);
            waiting[edge.from].insert(edge.to);
        }
        let mut waves: Vec<Option<usize>> = vec![None; waits.len()];
        let mut least = vec![0; waits.len()];
        let mut ready: Vec<usize> = (0..waits.len()).filter(|instance| waits[*instance].is_empty()).collect();
        while let Some(instance) = ready.pop() {
            let wave = least[instance];
            waves[instance] = Some(wave);
            for &next in &waiting[instance] {
                least[next] = least[next].max(wave + 1);
                waits[next].remove(&instance);
                if waits[next].is_empty() {
                    ready.push(next);
                }
            }
        }
        if let Some(stuck) = waves.iter().position(Option::is_none) {
            return self.refuse(self.circle_of_waves(&edges, &waves, stuck));
        }
        waves.into_iter().collect()
    }

    fn circle_of_waves(&self, edges: &BTreeSet<Edge>, waves: &[Option<usize>], stuck: usize) -> Diagnostic {
        let circle = circle(edges, waves, stuck);
        let name = |instance: usize| self.script.instances[instance].name.as_str();
        let names: Vec<_> =
            circle.iter().map(|edge| name(edge.from)).chain(circle.first().map(|edge| name(edge.from))).collect();
        let message = format!("these connections wait for each other within one step: {}", names.join(" => "));
        let Some(usual) = circle.iter().find(|edge| self.shows_its_state(edge.from)).or(circle.first()) else {
            unreachable!("a circle has an edge");
        };
        let wire = &self.script.wires[usual.wire].part;
        let example =
            self.text(wire.source.span.to(wire.targets.last().map_or(wire.source.span, |target| target.span)));
        let help = format!(
            "make one of them `->`, it then brings where the source stood when the step began; usual choice, the plant's output: `{}` (line {})",
            example.replacen("=>", "->", 1),
            self.line(wire.source.span)
        );
        let mut wires: Vec<_> = circle.iter().map(|edge| edge.wire).collect();
        wires.sort_unstable();
        wires.dedup();
        let mut spans = wires.into_iter().map(|wire| self.script.wires[wire].part.arrow_span);
        let first = spans.next().unwrap_or(wire.arrow_span);
        let error = spans.fold(Diagnostic::error("E06", first, message), |error, span| error.label(span, ""));
        let text = format!("write `{}`", example.replacen("=>", "->", 1));
        error.help(help).fix(text, [Edit::new(wire.arrow_span, "->")])
    }

    /// Whether an output is a state, as with a plant: it depends on no input at its own instant and starts at a value that the
    /// user gives. A sampled controller, whose outputs depend on no input at their own instant either, starts at none.
    fn shows_its_state(&self, instance: usize) -> bool {
        let unit = self.known(instance);
        let starts_at_a_value = |output: usize| match unit.initial_unknown(output) {
            Some(unknown) => unknown.dependencies.as_ref().is_none_or(|known| !known.is_empty()),
            None => unit.variables.get(output).is_some_and(|variable| variable.initial == Some(Initial::Exact)),
        };
        unit.structure
            .outputs
            .iter()
            .any(|output| output.dependencies.as_ref().is_some_and(Vec::is_empty) && starts_at_a_value(output.index))
    }
}

/// Walks back from an instance that waits until an instance comes again.
fn circle(edges: &BTreeSet<Edge>, waves: &[Option<usize>], stuck: usize) -> Vec<Edge> {
    let mut waits_for: BTreeMap<usize, Edge> = BTreeMap::new();
    for edge in edges.iter().filter(|edge| waves[edge.from].is_none()) {
        waits_for.entry(edge.to).or_insert(*edge);
    }
    let mut walked: Vec<Edge> = Vec::new();
    let mut steps: BTreeMap<usize, usize> = BTreeMap::new();
    let mut at = stuck;
    loop {
        let Some(edge) = waits_for.get(&at) else { unreachable!("an instance without wave waits for another") };
        steps.insert(at, walked.len());
        walked.push(*edge);
        at = edge.from;
        if let Some(&start) = steps.get(&at) {
            let mut circle = walked.split_off(start);
            circle.reverse();
            let first = (0..circle.len()).min_by_key(|&edge| circle[edge].from).unwrap_or(0);
            circle.rotate_left(first);
            return circle;
        }
    }
}
