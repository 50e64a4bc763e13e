//! Floating-point control of this thread: rounding, flush-to-zero, exception masks and the precision of the x87 unit.
//!
//! Every process begins with the values that are compared with here, and Lockstep never changes them.

#[cfg(target_arch = "x86_64")]
pub(crate) use x86_64::{has_changed, restore};

#[cfg(target_arch = "aarch64")]
pub(crate) use aarch64::{has_changed, restore};

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub(crate) use unknown::{has_changed, restore};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use crate::process_state::Changes;
    use std::arch::asm;

    const MXCSR: u32 = 0x1f80;
    /// Flags that any computation may set; they control nothing.
    const MXCSR_STATUS: u32 = 0x3f;
    const X87_CONTROL: u16 = 0x037f;

    #[inline]
    fn read() -> (u32, u16) {
        let (mut mxcsr, mut x87) = (0_u32, 0_u16);
        // SAFETY: both instructions only store a register to the given place. They count as access to all memory, so that the
        // compiler moves no load of a value across them.
        unsafe {
            asm!(
                "stmxcsr [{}]", "fnstcw [{}]", in(reg) &raw mut mxcsr, in(reg) &raw mut x87,
                options(nostack, preserves_flags)
            );
        }
        (mxcsr & !MXCSR_STATUS, x87)
    }

    /// Whether control is not what it is at the start of a process.
    #[inline]
    pub(crate) fn has_changed() -> bool {
        read() != (MXCSR, X87_CONTROL)
    }

    /// Sets control to what it is at the start of a process; returns what differed.
    #[cold]
    pub(crate) fn restore() -> Changes {
        let ((mxcsr, x87), usual) = (read(), MXCSR);
        // SAFETY: these are the values that the compiler expects between calls. `fninit` also drops pending exceptions, which
        // could else end the process at the next instruction; the x87 stack is empty after a call.
        unsafe { asm!("fninit", "ldmxcsr [{}]", in(reg) &raw const usual, options(nostack)) };
        let (mxcsr, x87) = (mxcsr ^ MXCSR, x87 ^ X87_CONTROL);
        let kinds = [
            (Changes::ROUNDING, 0x6000, 0x0c00),
            (Changes::FLUSH_TO_ZERO, 0x8040, 0),
            (Changes::EXCEPTIONS, 0x1f80, 0x003f),
            (Changes::PRECISION, 0, 0x0300),
        ];
        let differing = kinds.into_iter().filter(|(_, of_mxcsr, of_x87)| mxcsr & of_mxcsr != 0 || x87 & of_x87 != 0);
        differing.fold(Changes::NONE, |changes, (kind, ..)| changes | kind)
    }
}

#[cfg(target_arch = "aarch64")]
mod aarch64 {
    use crate::process_state::Changes;
    use std::arch::asm;

    #[inline]
    fn read() -> u64 {
        let control: u64;
        // SAFETY: only reads a register. It counts as access to all memory, so that the compiler moves no load of a value
        // across it.
        unsafe { asm!("mrs {}, fpcr", out(reg) control, options(nostack, preserves_flags)) };
        control
    }

    /// Whether control is not what it is at the start of a process.
    #[inline]
    pub(crate) fn has_changed() -> bool {
        read() != 0
    }

    /// Sets control to what it is at the start of a process; returns what differed.
    #[cold]
    pub(crate) fn restore() -> Changes {
        let control = read();
        // SAFETY: this is the value that the compiler expects between calls.
        unsafe { asm!("msr fpcr, {}", in(reg) 0_u64, options(nostack, preserves_flags)) };
        let kinds = [(Changes::ROUNDING, 3 << 22), (Changes::FLUSH_TO_ZERO, 1 << 24), (Changes::EXCEPTIONS, 0x9f << 8)];
        let differing = kinds.into_iter().filter(|(_, bits)| control & bits != 0);
        differing.fold(Changes::NONE, |changes, (kind, _)| changes | kind)
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod unknown {
    use crate::process_state::Changes;

    /// Nothing is known of control on this processor.
    #[inline]
    pub(crate) fn has_changed() -> bool {
        false
    }

    pub(crate) fn restore() -> Changes {
        Changes::NONE
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
pub(super) mod tests {
    use super::*;
    use std::arch::asm;

    /// Rounds down and flushes to zero.
    pub fn disturb() {
        let mxcsr = 0x1f80_u32 | 0x8040 | 0x2000;
        // SAFETY: the test restores it before it computes anything.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const mxcsr, options(nostack)) };
    }

    #[test]
    fn a_change_is_seen_named_and_restored() {
        assert!(!has_changed());
        disturb();
        let (seen, changes) = (has_changed(), restore());
        assert!(seen && !has_changed());
        assert_eq!(changes.to_string(), "the rounding mode and flush-to-zero");
        let x87 = 0x007f_u16;
        // SAFETY: as in `disturb`.
        unsafe { asm!("fldcw [{}]", in(reg) &raw const x87, options(nostack)) };
        let (seen, changes) = (has_changed(), restore());
        assert!(seen && !has_changed());
        assert_eq!(changes.to_string(), "the x87 precision");
    }
}
