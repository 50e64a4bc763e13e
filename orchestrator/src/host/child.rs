//! The stepping process: reads its specification from standard input, runs it, and reports to its parent on the board.
//!
//! Standard input stays open as long as the parent lives; when it closes, so does this process.

use crate::host::orphan::end_when_orphaned;
use crate::run::exercise::perform;
use crate::run::run_spec::RunSpec;
use crate::run::stepping::step_run;
use std::io::{self, Read};
use std::sync::Arc;
use unit::board::Board;

/// A longer specification is invalid; checkpoints of many units may be large.
const LONGEST_SPEC: u64 = 1 << 36;

/// Runs the specification on standard input. The result is on the board, even if the run breaks.
///
/// # Errors
/// There is no specification, or the board that it names cannot be opened, so that nothing can be reported there.
pub fn run() -> io::Result<()> {
    let spec = read_spec(&mut io::stdin().lock())?;
    let board = Arc::new(Board::open(&spec.board)?);
    end_when_orphaned(spec.board.parent());
    match spec.options.exercise {
        None => step_run(&spec, &board),
        Some(exercise) => perform(&spec, &board, exercise),
    }
    Ok(())
}

/// Reads a spec: its length as 8 bytes, the lowest first, then the spec itself.
///
/// # Errors
/// The input ends early or holds no spec.
pub fn read_spec(input: &mut impl Read) -> io::Result<RunSpec> {
    let mut length = [0; 8];
    input.read_exact(&mut length)?;
    let length = u64::from_le_bytes(length);
    let mut bytes = Vec::new();
    if length > LONGEST_SPEC || input.take(length).read_to_end(&mut bytes)? as u64 != length {
        return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the specification on standard input is cut short"));
    }
    postcard::from_bytes(&bytes).map_err(|error| {
        io::Error::new(io::ErrorKind::InvalidData, format!("no specification on standard input: {error}"))
    })
}
