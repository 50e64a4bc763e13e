//! The child of a run: this program once more, which reads its specification from standard input.
//!
//! Its standard input stays open as long as the parent lives; by its end the child detects that the parent has ended.
//! What units print on either stream goes to the parent's standard error.

use super::{Stepping, cause_of_death};
use crate::run::run_spec::RunSpec;
use std::io::{self, Write};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use unit::failure::Cause;
use unit::process;

/// The subcommand that the child is started with.
pub const SUBCOMMAND: &str = "step-loop";

/// A child that does not outlive this value.
#[derive(Debug)]
pub(super) struct SteppingProcess {
    child: Child,
    status: Option<ExitStatus>,
}

impl SteppingProcess {
    /// Starts the child, in a process group of its own so that Ctrl-C reaches it through the parent only.
    pub fn start(program: &Path, spec: &RunSpec) -> io::Result<Self> {
        let bytes = postcard::to_stdvec(spec).map_err(io::Error::other)?;
        let stderr = io::stderr().as_fd().try_clone_to_owned()?;
        let mut command = Command::new(program);
        command.arg(SUBCOMMAND).stdin(Stdio::piped()).stdout(stderr).process_group(0);
        let mut process = Self { child: command.spawn()?, status: None };
        match process.send(&bytes) {
            // A child that has ended already reports the reason by its exit status.
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
            _ => Ok(process),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let stdin = self.child.stdin.as_mut().unwrap_or_else(|| unreachable!("its standard input is a pipe"));
        stdin.write_all(&(bytes.len() as u64).to_le_bytes())?;
        stdin.write_all(bytes)?;
        stdin.flush()
    }
}

impl Stepping for SteppingProcess {
    fn ended(&mut self) -> io::Result<Option<Cause>> {
        if self.status.is_none() {
            // Not `wait`, which would close its standard input first.
            self.status = self.child.try_wait()?;
        }
        Ok(self.status.map(cause_of_death))
    }

    fn reap_adopted(&self) {
        process::reap_adopted(|process| process == self.child.id());
    }

    fn is_stopped(&self) -> bool {
        process::is_stopped(self.child.id())
    }

    fn kill(&mut self) {
        // It may have ended already, which `ended` reports.
        let _ = self.child.kill();
    }
}

impl Drop for SteppingProcess {
    fn drop(&mut self) {
        if self.status.is_none() {
            self.kill();
            let _ = self.child.wait();
        }
    }
}
