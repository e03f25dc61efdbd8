//! The widest instructions that the machine has, chosen once while running.

/// Instructions that a computation may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every machine of the architecture has.
    Plain,
    /// 256-bit registers for integers and floating-point numbers.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

/// A computation that is compiled once for each kind of instructions.
///
/// Everything it calls in its loops must be inlined into `run`. The results are the same to the last bit: the compiler
/// never fuses a product and a sum by itself.
pub trait Computation {
    /// What it results in.
    type Output;

    /// Does it; implementations are `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

impl Instructions {
    /// The best that this machine has.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Plain
    }

    /// Does a computation with these instructions.
    #[inline]
    #[allow(unsafe_code)]
    pub fn run<C: Computation>(self, computation: C) -> C::Output {
        match self {
            Self::Plain => computation.run(),
            // SAFETY: the machine has the instructions, for where there are none `run_avx2` is not reached: the variant
            // is made by `best` alone, after it has asked for them.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { run_avx2(computation) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<C: Computation>(computation: C) -> C::Output {
    computation.run()
}
