//! Floating-point control of this thread: rounding, flush-to-zero, exception masks and the precision of the x87 unit.
//!
//! Every process begins with the values that are compared with here, and Lockstep never changes them.

#[cfg(target_arch = "x86_64")]
pub(crate) use x86_64::{acts_otherwise, has_changed, restore};

#[cfg(target_arch = "aarch64")]
pub(crate) use aarch64::{acts_otherwise, has_changed, restore};

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub(crate) use unknown::{acts_otherwise, has_changed, restore};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use crate::process_state::Changes;
    use std::arch::asm;
    use std::mem::MaybeUninit;

    const MXCSR: u32 = 0x1f80;
    /// Flags that any computation may set; they control nothing.
    const MXCSR_STATUS: u32 = 0x3f;
    const X87_CONTROL: u16 = 0x037f;

    #[inline]
    fn mxcsr() -> u32 {
        let mut mxcsr = MaybeUninit::<u32>::uninit();
        // SAFETY: the instruction only stores a register to the given place, which is a number after it. It counts as access to
        // all memory, so that the compiler moves no load of a value across it.
        let mxcsr = unsafe {
            asm!("stmxcsr [{}]", in(reg) mxcsr.as_mut_ptr(), options(nostack, preserves_flags));
            mxcsr.assume_init()
        };
        mxcsr & !MXCSR_STATUS
    }

    #[inline]
    fn x87_control() -> u16 {
        let mut x87 = MaybeUninit::<u16>::uninit();
        // SAFETY: as for `mxcsr`.
        unsafe {
            asm!("fnstcw [{}]", in(reg) x87.as_mut_ptr(), options(nostack, preserves_flags));
            x87.assume_init()
        }
    }

    /// Whether control is not what it is at the start of a process.
    #[inline]
    pub(crate) fn has_changed() -> bool {
        mxcsr() != MXCSR || x87_control() != X87_CONTROL
    }

    /// Whether numbers are computed otherwise than at the start of a process, found by computing some: reading MXCSR takes
    /// several times as long on many processors, since it waits for all arithmetic before it. Exceptions that are unmasked for
    /// SSE alone are not found.
    #[inline(always)]
    pub(crate) fn acts_otherwise() -> bool {
        const ONE: f64 = 1.0;
        /// Less than half of the distance from one to the next number, so that sum and difference are one.
        const LITTLE: f64 = f64::EPSILON / 16.0;
        /// Smaller than any normal number.
        const SUBNORMAL: f64 = f64::MIN_POSITIVE / 16.0;
        let (mut one, mut little, mut subnormal) = (ONE, LITTLE, SUBNORMAL);
        // SAFETY: no instruction. The compiler neither knows the numbers after it nor moves it across the call before it.
        unsafe {
            asm!(
                "/* {} {} {} */", inout(xmm_reg) one, inout(xmm_reg) little, inout(xmm_reg) subnormal,
                options(nostack, preserves_flags)
            );
        }
        let differing = ((one + little).to_bits() ^ ONE.to_bits())
            | ((one - little).to_bits() ^ ONE.to_bits())
            | ((subnormal + subnormal).to_bits() ^ (2.0 * SUBNORMAL).to_bits());
        differing != 0 || x87_control() != X87_CONTROL
    }

    /// Sets control to what it is at the start of a process; returns what differed.
    #[cold]
    pub(crate) fn restore() -> Changes {
        let (mxcsr, x87, usual) = (mxcsr(), x87_control(), MXCSR);
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

    /// Whether numbers are computed otherwise than at the start of a process.
    #[inline]
    pub(crate) fn acts_otherwise() -> bool {
        has_changed()
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

    #[inline]
    pub(crate) fn acts_otherwise() -> bool {
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

    fn set_mxcsr(mxcsr: u32) {
        // SAFETY: the test restores it before it computes anything.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const mxcsr, options(nostack)) };
    }

    /// Rounds down and flushes to zero.
    pub fn disturb() {
        set_mxcsr(0x1f80 | 0x8040 | 0x2000);
    }

    #[test]
    fn each_change_is_seen_named_and_restored() {
        assert!(!has_changed() && !acts_otherwise());
        for (mxcsr, name) in [
            (0x2000, "the rounding mode"),
            (0x4000, "the rounding mode"),
            (0x6000, "the rounding mode"),
            (0x8000, "flush-to-zero"),
            (0x0040, "flush-to-zero"),
            (0x8040 | 0x2000, "the rounding mode and flush-to-zero"),
        ] {
            set_mxcsr(0x1f80 | mxcsr);
            let (seen, acts, changes) = (has_changed(), acts_otherwise(), restore());
            assert!(seen && acts && !has_changed() && !acts_otherwise(), "{mxcsr:#x}");
            assert_eq!(changes.to_string(), name);
        }
        for (x87, name) in [
            (0x007f_u16, "the x87 precision"),
            (0x077f, "the rounding mode"),
            (0x0376, "the floating-point exception masks"),
        ] {
            // SAFETY: as in `set_mxcsr`.
            unsafe { asm!("fldcw [{}]", in(reg) &raw const x87, options(nostack)) };
            let (seen, acts, changes) = (has_changed(), acts_otherwise(), restore());
            assert!(seen && acts && !has_changed(), "{x87:#x}");
            assert!(changes.to_string().contains(name), "{changes}");
        }
        set_mxcsr(0x1f80 & !0x0080);
        let (seen, changes) = (has_changed(), restore());
        assert!(seen && changes.to_string().contains("exception masks"), "{changes}");
    }
}
