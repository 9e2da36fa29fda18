//! Instruction sets: the same kernels, compiled once for each, chosen when the program runs.
//!
//! Design: `docs/design/kernels.md`.

use fearless_simd::{Level, Simd};

/// An instruction set that the kernels were compiled for. All give the same bits; they differ in speed alone.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Isa {
    /// Registers of four numbers, which every x86-64 has.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Sse2(fearless_simd::x86::Sse2),
    /// Registers of eight.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2(fearless_simd::x86::Avx2),
    /// Registers of sixteen.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512(fearless_simd::x86::Avx512),
    /// The instruction set of a machine that is no x86.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    Native(Level),
}

impl Default for Isa {
    fn default() -> Self {
        Self::detected()
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl Isa {
    /// The best that this machine has.
    ///
    /// # Panics
    /// On an x86 older than SSE2, of the year 2000.
    pub fn detected() -> Self {
        let level = Level::new();
        let widest = level.as_avx512().map(Self::Avx512).or(level.as_avx2().map(Self::Avx2));
        widest.or(level.as_sse2().map(Self::Sse2)).expect("every x86 since 2000 has SSE2")
    }

    /// All that this machine has, the narrowest first.
    pub fn available() -> Vec<Self> {
        let level = Level::new();
        let narrow = [level.as_sse2().map(Self::Sse2), level.as_avx2().map(Self::Avx2)];
        narrow.into_iter().chain([level.as_avx512().map(Self::Avx512)]).flatten().collect()
    }

    /// Its name, as in tables of figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sse2(_) => "sse2",
            Self::Avx2(_) => "avx2",
            Self::Avx512(_) => "avx512",
        }
    }

    /// Runs `kernel`, compiled for this instruction set.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Sse2(simd) => simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            ),
            Self::Avx2(simd) => simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            ),
            Self::Avx512(simd) => simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            ),
        }
    }
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
impl Isa {
    /// The best that this machine has.
    pub fn detected() -> Self {
        Self::Native(Level::new())
    }

    /// All that this machine has.
    pub fn available() -> Vec<Self> {
        vec![Self::detected()]
    }

    /// Its name, as in tables of figures.
    pub fn name(self) -> &'static str {
        "native"
    }

    /// Runs `kernel`, compiled for this instruction set.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        let Self::Native(level) = self;
        fearless_simd::dispatch!(level, simd => kernel.run(simd))
    }
}

/// Work to be compiled for every instruction set. Everything that it calls must be `#[inline(always)]`.
pub(crate) trait Kernel {
    /// The result of the work.
    type Output;
    /// The work.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}
