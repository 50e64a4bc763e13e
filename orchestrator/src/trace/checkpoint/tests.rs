//! Checkpoint files that are fine, and bytes that are not.
