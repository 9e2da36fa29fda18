//! Instruction sets: the same kernels, compiled once for each, chosen when the program runs.

use fearless_simd::{Level, Simd, dispatch};

/// An instruction set that the kernels were compiled for. All give the same bits; they differ in speed alone.
#[derive(Clone, Copy, Debug)]
pub struct Isa(Level);

impl Default for Isa {
    fn default() -> Self {
        Self::detected()
    }
}

impl Isa {
    /// The best that this machine has.
    pub fn detected() -> Self {
        Self(Level::new())
    }

    /// All that this machine has, the narrowest first.
    pub fn available() -> Vec<Self> {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let levels = {
            let best = Level::new();
            let narrow = [best.as_sse2().map(Simd::level), best.as_sse4_2().map(Simd::level)];
            let wide = [best.as_avx2().map(Simd::level), best.as_avx512().map(Simd::level)];
            narrow.into_iter().chain(wide).flatten()
        };
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let levels = core::iter::once(Level::new());
        levels.map(Self).collect()
    }

    /// Its name, as in tables of figures.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse2(_) => "sse2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse4_2(_) => "sse4.2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "scalar",
        }
    }

    /// Runs `kernel`, compiled for this instruction set.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        dispatch!(self.0, simd => kernel.run(simd))
    }
}

/// Work to be compiled for every instruction set. Everything that it calls must be `#[inline(always)]`.
pub(crate) trait Kernel {
    /// What it gives.
    type Output;
    /// The work.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}
