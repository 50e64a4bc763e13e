//! Versions of glibc's functions that older systems have too, so that units load where glibc is at least 2.28.
//!
//! Rust's standard library calls these functions, and the linker binds a call to the newest version of a function: a unit
//! linked on a new system would not load on an older one. The definitions here are hidden: they take the place of glibc's
//! inside of the unit alone, and pass each call to the version that every glibc for x86-64 has.
#![allow(unsafe_code, reason = "functions of the C library under their own names")]

// Each function passes its arguments on unchanged, by the calling convention of System V; `stat64` and `fstat64` put the
// version of `struct stat` before them, as glibc's own headers did before 2.33; `gettid` is the system call itself.
std::arch::global_asm!(
    ".macro lockstep_old name",
    ".symver lockstep_old_\\name, \\name@GLIBC_2.2.5",
    ".pushsection .text.\\name, \"ax\", @progbits",
    ".globl \\name",
    ".hidden \\name",
    ".type \\name, @function",
    "\\name:",
    "jmp lockstep_old_\\name@PLT",
    ".size \\name, . - \\name",
    ".popsection",
    ".endm",
    "lockstep_old pthread_key_create",
    "lockstep_old pthread_key_delete",
    "lockstep_old pthread_setspecific",
    ".purgem lockstep_old",
    ".macro lockstep_old_stat name, old",
    ".symver lockstep_old_\\name, \\old@GLIBC_2.2.5",
    ".pushsection .text.\\name, \"ax\", @progbits",
    ".globl \\name",
    ".hidden \\name",
    ".type \\name, @function",
    "\\name:",
    "mov rdx, rsi",
    "mov rsi, rdi",
    "mov edi, 1",
    "jmp lockstep_old_\\name@PLT",
    ".size \\name, . - \\name",
    ".popsection",
    ".endm",
    "lockstep_old_stat stat64, __xstat64",
    "lockstep_old_stat fstat64, __fxstat64",
    ".purgem lockstep_old_stat",
    ".pushsection .text.gettid, \"ax\", @progbits",
    ".globl gettid",
    ".hidden gettid",
    ".type gettid, @function",
    "gettid:",
    "mov eax, 186",
    "syscall",
    "ret",
    ".size gettid, . - gettid",
    ".popsection",
);
