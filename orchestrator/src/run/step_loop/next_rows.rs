//! The rows behind a checkpoint: kept with it, and compared when a run continues, since a unit whose saved state is
//! incomplete would otherwise go on with other values, unnoticed.

use super::{Checkpoint, Observer, State, StepLoop};
use crate::run::start_values::value_text;
use flatten::values::{Slot, ValueType, Values};
use flatten::wiring::{Names, Plan};
use std::collections::VecDeque;
use unit::failure::Failure;

/// How many rows are kept at least, and how many at most.
const LEAST_ROWS: u64 = 10;
const MOST_ROWS: u64 = 1000;

const TYPES: [ValueType; 4] = [ValueType::Real, ValueType::Integer, ValueType::Boolean, ValueType::Text];

/// The outputs of all instances at one tick, in the script's order.
pub(super) type Row = Vec<Values>;

/// What is left to keep and to compare.
#[derive(Debug, Default)]
pub(super) struct NextRows {
    /// Checkpoints that do not have all their rows yet.
    open: Vec<Checkpoint>,
    /// The rows that the saved run had, from the next tick on.
    expected: VecDeque<Row>,
}

impl NextRows {
    /// Whether rows are to be kept or compared.
    #[inline]
    pub fn are_due(&self) -> bool {
        !(self.open.is_empty() && self.expected.is_empty())
    }

    /// Keeps the rows that follow this checkpoint, which its file does not have yet.
    pub fn keep(&mut self, checkpoint: Checkpoint) {
        self.open.push(checkpoint);
    }

    /// Compares the rows of a run that continues with these.
    pub fn expect(&mut self, rows: &[Row]) {
        self.expected = rows.iter().cloned().collect();
    }
}

/// Each instance delivers at least twice within the rows that are kept, unless its period is very long.
fn rows_of(plan: &Plan) -> usize {
    let longest = plan.groups.iter().map(|group| group.every).max().unwrap_or(1);
    usize::try_from(longest.saturating_mul(2).clamp(LEAST_ROWS, MOST_ROWS)).unwrap_or(usize::MAX)
}

impl<W: Observer> StepLoop<'_, W> {
    /// Takes the outputs of this tick: compares them where the run continues, and keeps them for checkpoints.
    ///
    /// # Errors
    /// An instance that was restored has other outputs than when it was saved, or a checkpoint cannot be stored.
    #[cold]
    pub(super) fn take_next_row(&mut self, tick: u64) -> Result<(), Failure> {
        let Self { plan, state, .. } = self;
        let State { next_rows, visible, .. } = state;
        let row: Row = plan.ports.iter().map(|ports| ports.outputs.values(visible)).collect();
        if let Some(expected) = next_rows.expected.pop_front()
            && let Some((instance, change)) = first_change(plan, &expected, &row)
        {
            return Err(Failure::not_restored(plan.names[instance].instance.clone(), plan.seconds(tick), change));
        }
        let rows = rows_of(plan);
        next_rows.open.iter_mut().for_each(|checkpoint| checkpoint.next.push(row.clone()));
        self.store_next_rows(|checkpoint| checkpoint.next.len() >= rows)
    }

    /// Stores the checkpoints that are complete by this judgement once more, with their rows.
    ///
    /// # Errors
    /// One cannot be stored.
    pub(super) fn store_next_rows(&mut self, complete: impl Fn(&Checkpoint) -> bool) -> Result<(), Failure> {
        let open = std::mem::take(&mut self.state.next_rows.open);
        let (complete, open): (Vec<_>, Vec<_>) = open.into_iter().partition(complete);
        self.state.next_rows.open = open;
        complete.iter().try_for_each(|checkpoint| self.store(checkpoint))
    }
}

/// The first instance whose outputs are others than expected, with the output and both values. Instances that step in an
/// earlier wave come first, as those may be why later ones differ.
fn first_change(plan: &Plan, expected: &[Values], row: &[Values]) -> Option<(usize, String)> {
    let mut by_wave = plan.groups.iter().flat_map(|group| &group.instances);
    by_wave.find_map(|&instance| Some((instance, change(plan, instance, &expected[instance], &row[instance])?)))
}

/// `y is 1.2, was 1.3`, of the first output that differs.
fn change(plan: &Plan, instance: usize, was: &Values, is: &Values) -> Option<String> {
    let Names { reals, others: [integers, booleans, texts], .. } = &plan.names[instance];
    let names = [reals, integers, booleans, texts];
    let by_type = TYPES.into_iter().zip(names);
    let mut outputs = by_type.flat_map(|(base, names)| (0..).map(move |index| Slot { base, index }).zip(names));
    let (slot, name) = outputs.find(|(slot, _)| !is.is_same(was, *slot))?;
    Some(format!("{name} is {}, was {}", value_text(is, slot), value_text(was, slot)))
}
