//! Verdicts at the first sample after which they cannot change.
//!
//! A claim whose parts look ahead, or reach to the end of the run inside of others, has its margin late, but often its
//! verdict before. So here each part of such a claim is true, false or not known at each tick, and what becomes known is
//! passed on to the parts that use it. Each value becomes known once, so that a sample costs on average a few steps for
//! each part. Margins come from `stream.rs` and `history.rs`.

mod memory;

pub(super) use memory::EarlyMemory;

use super::judged::Join;
use super::memory::Layout;
use super::stream::{Atom, Sample, horizon, is_bounded, reach_before, reach_of_body};
use crate::expression::SlotOf;
use dsl::scenario::{Formula, Gated, TickWindow, Until};
use memory::{NodeMemory, Update};

/// The parts of a claim, each behind those that it uses.
#[derive(Debug, Default)]
pub struct Early {
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    kind: Kind,
    /// The ticks at which its values count.
    reach: TickWindow,
    /// How many ticks after a sample the values of its parts count: an operator that reaches to the end of the run
    /// ranges over the ticks whose values fit into it.
    late: u64,
    /// The nodes that use its values.
    users: Vec<usize>,
}

#[derive(Debug)]
enum Kind {
    Atom(Atom),
    /// `and`, `or`, `implies`, of so many parts.
    Junction(Join, u64),
    /// `always`, `eventually`, with the node of its body.
    Window(Join, TickWindow, usize),
    /// `φ until g` from now on, with the nodes of φ and g: g, or φ and the same at the next tick.
    Step(Join, usize, usize),
    /// What a part is so many ticks later.
    Shift(u64),
    /// `finally`: not known before the end.
    AtEnd,
}

/// Whether a verdict is known late without this: an operator inside of a bounded one looks ahead, or one inside of another
/// reaches to the end of the run.
fn is_late(formula: &Formula) -> bool {
    let of_parts = |window: &TickWindow, parts: [&Formula; 2]| {
        let look_ahead = window.to.is_some() && parts.iter().any(|part| horizon(part) > 0);
        look_ahead || parts.iter().any(|part| !is_bounded(part))
    };
    match formula {
        Formula::Margin(_) | Formula::Condition(_) | Formula::Finally(_) => false,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().any(is_late),
        Formula::Gated(Gated { gate, body, .. }) => is_late(gate) || is_late(body),
        Formula::Always(window, body) | Formula::Eventually(window, body) => of_parts(window, [body, body]),
        Formula::Until(Until { window, gate, body, .. }) => of_parts(window, [gate, body]),
    }
}

impl Early {
    /// The parts of a claim; `None` if its verdict comes early without them.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Option<Self> {
        if !is_late(formula) {
            return None;
        }
        let mut early = Self::default();
        early.add(formula, TickWindow { from: 0, to: Some(0) }, layout, slot_of);
        Some(early)
    }

    fn add(&mut self, formula: &Formula, reach: TickWindow, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> usize {
        let join = Join::of(formula);
        match formula {
            Formula::Margin(_) | Formula::Condition(_) => {
                self.node(Kind::Atom(Atom::new(formula, layout, slot_of)), (reach, 0), &[])
            }
            Formula::Finally(_) => self.node(Kind::AtEnd, (reach, 0), &[]),
            Formula::And(parts) | Formula::Or(parts) => {
                let parts: Vec<_> = parts.iter().map(|part| self.add(part, reach, layout, slot_of)).collect();
                self.junction(join, reach, &parts)
            }
            Formula::Gated(Gated { gate, body, .. }) => {
                let parts = [gate, body].map(|part| self.add(part, reach, layout, slot_of));
                self.junction(join, reach, &parts)
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let late = if window.to.is_some() { 0 } else { horizon(body) };
                let body = self.add(body, reach_of_body(reach, *window), layout, slot_of);
                self.node(Kind::Window(join, *window, body), (reach, late), &[body])
            }
            Formula::Until(Until { window, gate, body, .. }) => {
                let late = if window.to.is_some() { 0 } else { horizon(gate).max(horizon(body)) };
                let [gate, body] =
                    [gate, body].map(|part| self.add(part, reach_before(reach, *window), layout, slot_of));
                self.until(join, (*window, late), reach, (body, gate))
            }
        }
    }

    /// `φ until within a..b g`: φ until g from a on, and φ before, and g within the window.
    fn until(
        &mut self,
        join: Join,
        (window, late): (TickWindow, u64),
        reach: TickWindow,
        parts: (usize, usize),
    ) -> usize {
        let (body, gate) = parts;
        let step = Kind::Step(join, body, gate);
        let mut all = vec![self.node(step, (reach_of_body(reach, window), late), &[body, gate])];
        if window.from > 0 {
            all[0] = self.node(Kind::Shift(window.from), (reach, 0), &[all[0]]);
            let before = TickWindow { from: 0, to: Some(window.from - 1) };
            all.push(self.node(Kind::Window(join.opposite(), before, body), (reach, late), &[body]));
        }
        if window.to.is_some() {
            all.push(self.node(Kind::Window(join, window, gate), (reach, late), &[gate]));
        }
        self.junction(join.opposite(), reach, &all)
    }

    fn junction(&mut self, join: Join, reach: TickWindow, parts: &[usize]) -> usize {
        self.node(Kind::Junction(join, parts.len() as u64), (reach, 0), parts)
    }

    fn node(&mut self, kind: Kind, (reach, late): (TickWindow, u64), parts: &[usize]) -> usize {
        let node = self.nodes.len();
        parts.iter().for_each(|&part| self.nodes[part].users.push(node));
        self.nodes.push(Node { kind, reach, late, users: Vec::new() });
        node
    }

    /// Takes the sample of a tick; returns whether the verdict became known.
    pub(super) fn take(&self, memory: &mut EarlyMemory, tick: u64, sample: &mut Sample<'_>) -> bool {
        if memory.holds.is_some() {
            return false;
        }
        for (index, node) in self.nodes.iter().enumerate() {
            if let Kind::Atom(atom) = &node.kind
                && node.counts_at(tick)
            {
                let holds = atom.judge(tick, sample).holds();
                self.learn(memory, (index, tick), holds);
            }
        }
        self.pass_on(memory, tick);
        self.release(memory, tick);
        memory.holds = self.value(memory, self.nodes.len() - 1, 0);
        if memory.holds.is_some() {
            memory.nodes.iter_mut().for_each(|node| *node = NodeMemory::default());
        }
        memory.holds.is_some()
    }

    /// Passes on what becomes known, from the values of a part to those of its users.
    fn pass_on(&self, memory: &mut EarlyMemory, now: u64) {
        while let Some(Update { node, tick, holds }) = memory.updates.pop() {
            for &user in &self.nodes[node].users {
                self.use_value(memory, user, Update { node, tick, holds }, now);
            }
        }
    }

    /// Passes on the values that count from this tick on.
    fn release(&self, memory: &mut EarlyMemory, now: u64) {
        for node in 0..self.nodes.len() {
            for &user in &self.nodes[node].users {
                let late = self.nodes[user].late;
                if late > 0
                    && let Some(tick) = now.checked_sub(late)
                    && let Some(holds) = self.value(memory, node, tick)
                {
                    self.use_value(memory, user, Update { node, tick, holds }, now);
                }
            }
        }
        self.pass_on(memory, now);
    }

    fn use_value(&self, memory: &mut EarlyMemory, user: usize, of: Update, now: u64) {
        let Update { node, tick, holds } = of;
        let Node { kind, late, .. } = &self.nodes[user];
        if tick.saturating_add(*late) > now {
            return;
        }
        match *kind {
            Kind::Atom(_) | Kind::AtEnd => {}
            Kind::Shift(by) => {
                if let Some(at) = tick.checked_sub(by) {
                    self.learn(memory, (user, at), holds);
                }
            }
            Kind::Junction(join, parts) => {
                if holds == join.decider() || self.count(memory, user, tick) == parts {
                    self.learn(memory, (user, tick), holds);
                }
            }
            Kind::Step(join, body, gate) => self.step(memory, user, (join, body, gate), (tick, now)),
            Kind::Window(join, window, _) if holds == join.decider() => {
                self.decide_window(memory, user, window, (tick, holds))
            }
            Kind::Window(_, window, _) => self.complete_window(memory, user, window, (node, tick, holds)),
        }
    }

    /// One value of the body decides all windows that it is in.
    fn decide_window(&self, memory: &mut EarlyMemory, user: usize, window: TickWindow, (tick, holds): (u64, bool)) {
        let Some(last) = tick.checked_sub(window.from) else { return };
        let first = window.to.map_or(0, |to| tick.saturating_sub(to)).max(self.nodes[user].reach.from);
        let last = self.nodes[user].reach.to.map_or(last, |to| last.min(to));
        let begin = self.nodes[user].reach.from;
        let mut at = last;
        while at >= first {
            #[cfg(test)]
            STEPS.set(STEPS.get() + 1);
            let Some(index) = self.index(user, at) else { return };
            // What is known here was decided by another value of the body, together with what is below.
            let below = memory.nodes[user].decided_from(index).map_or(at, |index| begin.saturating_add(index).min(at));
            self.learn(memory, (user, at), holds);
            memory.nodes[user].note_decided(index, first - begin);
            match below.checked_sub(1) {
                Some(next) => at = next,
                None => return,
            }
        }
    }

    /// A value of the body that decides nothing completes the windows in which all others are known.
    fn complete_window(
        &self,
        memory: &mut EarlyMemory,
        user: usize,
        window: TickWindow,
        (node, tick, holds): (usize, u64, bool),
    ) {
        let Some(to) = window.to else { return };
        let Some(index) = self.index(node, tick) else { return };
        let begin = self.nodes[node].reach.from;
        let (first, last) = memory.nodes[user].join_run(index);
        let (first, last) = (begin + first, begin + last);
        let Some(highest) = tick.checked_sub(window.from).zip(last.checked_sub(to)).map(|(a, b)| a.min(b)) else {
            return;
        };
        let lowest = first.saturating_sub(window.from).max(tick.saturating_sub(to));
        for at in (lowest..=highest).rev() {
            self.learn(memory, (user, at), holds);
        }
    }

    /// `until` at a tick, and at those before as long as more becomes known.
    fn step(&self, memory: &mut EarlyMemory, user: usize, parts: (Join, usize, usize), (tick, now): (u64, u64)) {
        let (join, body, gate) = parts;
        let counts = |at: u64| at.saturating_add(self.nodes[user].late) <= now;
        for at in (self.nodes[user].reach.from..=tick).rev() {
            let part = |node: usize| self.value(memory, node, at).filter(|_| counts(at));
            let rest = join.opposite().of_two(part(body), self.value(memory, user, at + 1));
            let Some(holds) = join.of_two(part(gate), rest) else { return };
            if self.value(memory, user, at).is_some() || !self.nodes[user].counts_at(at) {
                return;
            }
            self.learn(memory, (user, at), holds);
        }
    }

    /// How many parts of a junction at a tick are known, with one more.
    fn count(&self, memory: &mut EarlyMemory, user: usize, tick: u64) -> u64 {
        self.index(user, tick).map_or(0, |index| memory.nodes[user].count(index))
    }

    fn learn(&self, memory: &mut EarlyMemory, (node, tick): (usize, u64), holds: bool) {
        if let Some(index) = self.index(node, tick)
            && memory.nodes[node].learn(index, holds)
        {
            memory.updates.push(Update { node, tick, holds });
        }
    }

    fn value(&self, memory: &EarlyMemory, node: usize, tick: u64) -> Option<bool> {
        memory.nodes[node].value(self.index(node, tick)?)
    }

    /// The place of a tick in the memory of a node; `None` if its value there does not count.
    fn index(&self, node: usize, tick: u64) -> Option<u64> {
        let node = &self.nodes[node];
        node.counts_at(tick).then(|| tick - node.reach.from)
    }

    /// The memory before the first sample.
    pub(super) fn memory(&self) -> EarlyMemory {
        let nodes = self.nodes.iter().map(|_| NodeMemory::default()).collect();
        EarlyMemory { holds: None, nodes, updates: Vec::new() }
    }

    /// Allocates what a run up to this tick needs.
    pub(super) fn reserve(&self, memory: &mut EarlyMemory, stop_tick: u64, most: usize) {
        if memory.holds.is_some() {
            return;
        }
        let ticks = |node: &Node| {
            let last = node.reach.to.map_or(stop_tick, |to| to.min(stop_tick));
            let ticks = last.saturating_add(1).saturating_sub(node.reach.from);
            usize::try_from(ticks).unwrap_or(usize::MAX).min(most)
        };
        for (node, memory) in self.nodes.iter().zip(&mut memory.nodes) {
            match node.kind {
                Kind::Junction(..) => memory.reserve(ticks(node), ticks(node), 0),
                Kind::Window(_, _, body) => memory.reserve(ticks(node), ticks(node), ticks(&self.nodes[body])),
                _ => memory.reserve(ticks(node), 0, 0),
            }
        }
    }

    /// Whether a memory of whatever origin can be that of this claim after so many samples.
    pub(super) fn fits(&self, memory: &EarlyMemory, samples: u64) -> bool {
        memory.updates.is_empty()
            && memory.nodes.len() == self.nodes.len()
            && memory.nodes.iter().all(|node| node.fits(samples))
    }
}

impl Node {
    fn counts_at(&self, tick: u64) -> bool {
        self.reach.from <= tick && self.reach.to.is_none_or(|to| tick <= to)
    }
}

#[cfg(test)]
thread_local! {
    /// How many ticks windows have looked at.
    static STEPS: std::cell::Cell<u64> = const { std::cell::Cell::new(0) };
}

#[cfg(test)]
/// The number of ticks that windows look at while some work is done.
pub(super) fn steps_of(work: impl FnOnce()) -> u64 {
    STEPS.set(0);
    work();
    STEPS.get()
}

impl Join {
    /// The value that alone decides the joined value.
    fn decider(self) -> bool {
        self == Self::Any
    }

    /// Two values joined, as far as they are known.
    fn of_two(self, one: Option<bool>, other: Option<bool>) -> Option<bool> {
        let decider = self.decider();
        match (one, other) {
            (Some(value), _) | (_, Some(value)) if value == decider => Some(decider),
            (Some(_), Some(_)) => Some(!decider),
            _ => None,
        }
    }
}
