//! Processor instruction sets for computing moments.

#[cfg(all(target_arch = "aarch64", target_endian = "little"))]
use super::neon;
use super::{ElementMoments, MomentsKernel, portable};
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512, sse2};

/// Implementation of the moments for an instruction set. All give bit-identical moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Instructions {
    /// AVX-512 with byte products (F, BW, VNNI), on x86-64.
    Avx512Vnni,
    /// AVX2, on x86-64.
    Avx2,
    /// SSE2, on every x86-64.
    Sse2,
    /// NEON, on 64-bit ARM.
    Neon,
    /// Portable code for any target.
    Portable,
}

impl Instructions {
    /// Instruction sets available on this processor, the fastest first.
    pub fn available() -> impl Iterator<Item = Self> {
        let all = [
            Self::Avx512Vnni,
            Self::Avx2,
            Self::Sse2,
            Self::Neon,
            Self::Portable,
        ];
        all.into_iter()
            .filter(|instructions| instructions.are_available())
    }

    /// Fastest instruction set available on this processor.
    pub fn fastest() -> Self {
        Self::available().next().unwrap_or(Self::Portable)
    }

    /// Returns whether the instruction set is available on this processor.
    pub fn are_available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512Vnni => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512vnni")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => is_x86_feature_detected!("sse2"),
            #[cfg(all(target_arch = "aarch64", target_endian = "little"))]
            Self::Neon => std::arch::is_aarch64_feature_detected!("neon"),
            Self::Portable => true,
            _ => false,
        }
    }

    /// Computes the moments of all elements in `pixels` while prefetching `next`. Excess `moments` are ignored. If the
    /// processor lacks the instructions, the portable implementation is used.
    pub(super) fn measure(
        self,
        kernel: &MomentsKernel,
        pixels: &[u8],
        next: &[u8],
        moments: &mut [ElementMoments],
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the guard has checked that the processor has the instructions.
            Self::Avx512Vnni if self.are_available() => unsafe {
                avx512::all_moments(kernel, pixels, next, moments);
            },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the guard has checked that the processor has the instructions.
            Self::Avx2 if self.are_available() => unsafe {
                avx2::all_moments(kernel, pixels, next, moments);
            },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the guard has checked that the processor has the instructions.
            Self::Sse2 if self.are_available() => unsafe {
                sse2::all_moments(kernel, pixels, next, moments);
            },
            #[cfg(all(target_arch = "aarch64", target_endian = "little"))]
            // SAFETY: the guard has checked that the processor has the instructions.
            Self::Neon if self.are_available() => unsafe {
                neon::all_moments(kernel, pixels, next, moments);
            },
            _ => portable::all_moments(kernel, pixels, next, moments),
        }
    }
}
