//! Arithmetic on several numbers at once, with the widest instructions that the machine has.
//!
//! Unsafe code here tells the compiler that instructions are available. Both versions of each function do the same
//! operations in the same order, none of them fused, so that they return the same bits.
#![allow(unsafe_code)]

use super::slabs::{Child, Slabs, WIDTH};

/// Number of triangles that are tested together.
pub const GROUP: usize = 4;

/// The vector operations of a walk through a tree.
pub trait Vectors: Copy {
    /// Returns a bit for each of eight boxes that a ray may enter before `reach`, and the keys of all of them.
    ///
    /// `first` and `last` are the sides where the ray enters and leaves. A key has the bits of the distance at which
    /// the ray enters, and below them those of the child. Keys are in the order of distances, because distances are not
    /// negative.
    fn enter(
        self,
        first: BoxSides,
        last: BoxSides,
        children: &[Child; WIDTH],
        slabs: &Slabs,
        reach: f32,
    ) -> (u32, Keys);

    /// Returns where a line meets four triangles with 0 < t <= `t_max`, or `None` if the edge functions of each
    /// triangle have both signs.
    ///
    /// `corners` holds rows of x, y and z, in the order of the line's axes, for each of three corners.
    fn meet<T: Number>(self, corners: [[&[T; GROUP]; 3]; 3], line: &Line, t_max: f64) -> Option<Crossings>;
}

/// A ray in the form that the test of four triangles takes: sheared so that it runs along its third axis.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub origin: [f64; 3],
    pub shear: [f64; 3],
    /// How far a triangle's plane must be from the origin for rounding not to matter, relative to the triangle's size.
    pub near: f64,
}

/// Where a line meets four triangles.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// A bit for each triangle that the line meets.
    pub hits: u32,
    /// A bit for each triangle that needs more digits: an edge function is 0, or the line starts near the plane.
    pub unsure: u32,
    pub t: [f64; GROUP],
    /// The affine coordinates are v and w divided by the determinant.
    pub v: [f64; GROUP],
    pub w: [f64; GROUP],
    pub determinant: [f64; GROUP],
}

/// A computation that is compiled once for each instruction set.
pub trait Computation {
    /// Result of the computation.
    type Output;

    /// Runs the computation. Implementations are `#[inline(always)]`.
    fn run<V: Vectors>(self, vectors: V) -> Self::Output;
}

/// One side of eight boxes on each axis.
pub type BoxSides<'a> = [&'a [f32; WIDTH]; 3];

/// Entry distances of eight boxes, each with its child.
pub type Keys = [u64; WIDTH];

/// The type of a coordinate as it is stored.
pub trait Number: Copy + Into<f64> {
    /// Widens four numbers to 64 bits.
    #[cfg(target_arch = "x86_64")]
    fn widened(_: avx2::Avx2, numbers: &[Self; GROUP]) -> std::arch::x86_64::__m256d;
}

/// The instructions that every machine of the architecture has.
#[derive(Clone, Copy, Debug)]
pub struct Plain;

impl Vectors for Plain {
    #[inline(always)]
    fn enter(
        self,
        first: BoxSides,
        last: BoxSides,
        children: &[Child; WIDTH],
        slabs: &Slabs,
        reach: f32,
    ) -> (u32, Keys) {
        let (mut near, mut far) = ([0.0; WIDTH], [reach; WIDTH]);
        for axis in 0..3 {
            for i in 0..WIDTH {
                let enter = (first[axis][i] - slabs.entry[axis]) * slabs.entry_inverse[axis];
                near[i] = if enter > near[i] { enter } else { near[i] };
                let leave = (last[axis][i] - slabs.exit[axis]) * slabs.exit_inverse[axis];
                far[i] = if leave < far[i] { leave } else { far[i] };
            }
        }
        let entered = (0..WIDTH).fold(0, |entered, i| entered | u32::from(near[i] <= far[i]) << i);
        (entered, std::array::from_fn(|i| u64::from(near[i].to_bits()) << 32 | u64::from(children[i].0)))
    }

    #[inline(always)]
    fn meet<T: Number>(self, corners: [[&[T; GROUP]; 3]; 3], line: &Line, t_max: f64) -> Option<Crossings> {
        let (mut hits, mut unsure, [mut t, mut v, mut w, mut determinant]) = (0, 0, [[0.0; GROUP]; 4]);
        for i in 0..GROUP {
            let mut size = 0.0_f64;
            let [a, b, c] = corners.map(|[x, y, z]| {
                let [x, y, z] =
                    [x[i].into() - line.origin[0], y[i].into() - line.origin[1], z[i].into() - line.origin[2]];
                size = size.max(x.abs()).max(y.abs()).max(z.abs());
                [x - line.shear[0] * z, y - line.shear[1] * z, z]
            });
            let u = c[0] * b[1] - c[1] * b[0];
            v[i] = a[0] * c[1] - a[1] * c[0];
            w[i] = b[0] * a[1] - b[1] * a[0];
            let none_below = u >= 0.0 && v[i] >= 0.0 && w[i] >= 0.0;
            let none_above = u <= 0.0 && v[i] <= 0.0 && w[i] <= 0.0;
            if none_below || none_above {
                determinant[i] = u + v[i] + w[i];
                let along = (u * a[2] + v[i] * b[2] + w[i] * c[2]) * line.shear[2];
                let is_near = along.abs() <= line.near * size * size * size * line.shear[2].abs();
                let is_unsure = is_near || u == 0.0 || v[i] == 0.0 || w[i] == 0.0;
                t[i] = along / determinant[i];
                hits |= u32::from(!is_unsure && t[i] > 0.0 && t[i] <= t_max) << i;
                unsure |= u32::from(is_unsure) << i;
            }
        }
        (hits | unsure != 0).then_some(Crossings { hits, unsure, t, v, w, determinant })
    }
}

/// Prefetches a value that will be used soon: a walk mostly waits for memory.
#[inline(always)]
pub fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..size_of::<T>().div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every machine of the architecture has SSE; a prefetch reads nothing and cannot fail.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(value).cast::<i8>().wrapping_add(64 * line)) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}

/// The instruction set, chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum Instructions {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
}

impl Instructions {
    /// Returns the best instructions that this machine has.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = avx2::Avx2::detect() {
            return Self::Avx2(avx2);
        }
        Self::Plain
    }

    /// Runs a computation with these instructions.
    #[inline]
    pub fn run<C: Computation>(self, computation: C) -> C::Output {
        match self {
            Self::Plain => computation.run(Plain),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(avx2) => avx2.run(computation),
        }
    }
}

#[cfg(target_arch = "x86_64")]
impl Number for f32 {
    #[inline(always)]
    fn widened(_: avx2::Avx2, numbers: &[Self; GROUP]) -> std::arch::x86_64::__m256d {
        use std::arch::x86_64::{__m128, _mm256_cvtps_pd};
        // SAFETY: an `Avx2` exists only where its instructions do; both the array and the vector are four 32-bit
        // numbers.
        unsafe { _mm256_cvtps_pd(std::mem::transmute::<[Self; GROUP], __m128>(*numbers)) }
    }
}

#[cfg(target_arch = "x86_64")]
impl Number for f64 {
    #[inline(always)]
    fn widened(_: avx2::Avx2, numbers: &[Self; GROUP]) -> std::arch::x86_64::__m256d {
        // SAFETY: both the array and the vector are four 64-bit numbers.
        unsafe { std::mem::transmute::<[Self; GROUP], std::arch::x86_64::__m256d>(*numbers) }
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Number for f32 {}

#[cfg(not(target_arch = "x86_64"))]
impl Number for f64 {}

#[cfg(target_arch = "x86_64")]
pub mod avx2 {
    use std::arch::x86_64::*;
    use std::mem::transmute;

    use super::{BoxSides, Child, Computation, Crossings, GROUP, Keys, Line, Number, Slabs, Vectors, WIDTH};

    /// Proof that the machine has AVX2, with 256-bit registers.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2(());

    impl Avx2 {
        pub fn detect() -> Option<Self> {
            std::arch::is_x86_feature_detected!("avx2").then_some(Self(()))
        }

        #[inline]
        pub fn run<C: Computation>(self, computation: C) -> C::Output {
            // SAFETY: an `Avx2` exists only where its instructions do.
            unsafe { run(self, computation) }
        }
    }

    #[target_feature(enable = "avx2")]
    fn run<C: Computation>(avx2: Avx2, computation: C) -> C::Output {
        computation.run(avx2)
    }

    impl Vectors for Avx2 {
        #[inline(always)]
        fn enter(
            self,
            first: BoxSides,
            last: BoxSides,
            children: &[Child; WIDTH],
            slabs: &Slabs,
            reach: f32,
        ) -> (u32, Keys) {
            // SAFETY: an `Avx2` exists only where its instructions do.
            unsafe { enter(first, last, children, slabs, reach) }
        }

        #[inline(always)]
        fn meet<T: Number>(self, corners: [[&[T; GROUP]; 3]; 3], line: &Line, t_max: f64) -> Option<Crossings> {
            // SAFETY: an `Avx2` exists only where its instructions do.
            unsafe { meet(self, corners, line, t_max) }
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn enter(first: BoxSides, last: BoxSides, children: &[Child; WIDTH], slabs: &Slabs, reach: f32) -> (u32, Keys) {
        // SAFETY: a child is a u32, and both the array and the vector are eight of them.
        let children = unsafe { transmute::<[Child; WIDTH], __m256i>(*children) };
        let (mut near, mut far) = (_mm256_setzero_ps(), _mm256_set1_ps(reach));
        for axis in 0..3 {
            // SAFETY: both the array and the vector are eight 32-bit numbers.
            let [first, last] = [first, last].map(|side| unsafe { transmute::<[f32; WIDTH], __m256>(*side[axis]) });
            let enter = _mm256_sub_ps(first, _mm256_set1_ps(slabs.entry[axis]));
            // Given a NaN and a number, both instructions return the second operand.
            near = _mm256_max_ps(_mm256_mul_ps(enter, _mm256_set1_ps(slabs.entry_inverse[axis])), near);
            let leave = _mm256_sub_ps(last, _mm256_set1_ps(slabs.exit[axis]));
            far = _mm256_min_ps(_mm256_mul_ps(leave, _mm256_set1_ps(slabs.exit_inverse[axis])), far);
        }
        let entered = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
        let near = _mm256_castps_si256(near);
        let (even, odd) = (_mm256_unpacklo_epi32(children, near), _mm256_unpackhi_epi32(children, near));
        let halves = [_mm256_permute2x128_si256::<0x20>(even, odd), _mm256_permute2x128_si256::<0x31>(even, odd)];
        // SAFETY: keys are 64-bit numbers, and each vector holds four of them.
        (entered as u32, unsafe { transmute::<[__m256i; 2], Keys>(halves) })
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn meet<T: Number>(avx2: Avx2, corners: [[&[T; GROUP]; 3]; 3], line: &Line, t_max: f64) -> Option<Crossings> {
        let [ox, oy, oz] = line.origin.map(|x| _mm256_set1_pd(x));
        let [sx, sy, sz] = line.shear.map(|x| _mm256_set1_pd(x));
        let differences = corners.map(|[x, y, z]| {
            let (x, y) = (_mm256_sub_pd(T::widened(avx2, x), ox), _mm256_sub_pd(T::widened(avx2, y), oy));
            [x, y, _mm256_sub_pd(T::widened(avx2, z), oz)]
        });
        let [a, b, c] = differences
            .map(|[x, y, z]| [_mm256_sub_pd(x, _mm256_mul_pd(sx, z)), _mm256_sub_pd(y, _mm256_mul_pd(sy, z)), z]);
        let u = _mm256_sub_pd(_mm256_mul_pd(c[0], b[1]), _mm256_mul_pd(c[1], b[0]));
        let v = _mm256_sub_pd(_mm256_mul_pd(a[0], c[1]), _mm256_mul_pd(a[1], c[0]));
        let w = _mm256_sub_pd(_mm256_mul_pd(b[0], a[1]), _mm256_mul_pd(b[1], a[0]));
        let zero = _mm256_setzero_pd();
        let none_below = _mm256_cmp_pd::<_CMP_GE_OQ>(_mm256_min_pd(_mm256_min_pd(u, v), w), zero);
        let none_above = _mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_max_pd(_mm256_max_pd(u, v), w), zero);
        let inside = _mm256_or_pd(none_below, none_above);
        if _mm256_movemask_pd(inside) == 0 {
            return None;
        }
        let determinant = _mm256_add_pd(_mm256_add_pd(u, v), w);
        let along = _mm256_add_pd(_mm256_mul_pd(u, a[2]), _mm256_mul_pd(v, b[2]));
        let along = _mm256_mul_pd(_mm256_add_pd(along, _mm256_mul_pd(w, c[2])), sz);
        let t = _mm256_div_pd(along, determinant);
        let sign = _mm256_set1_pd(-0.0);
        let size =
            differences.as_flattened().iter().fold(zero, |size, &x| _mm256_max_pd(size, _mm256_andnot_pd(sign, x)));
        let bound = _mm256_mul_pd(_mm256_mul_pd(_mm256_mul_pd(_mm256_set1_pd(line.near), size), size), size);
        let bound = _mm256_mul_pd(bound, _mm256_andnot_pd(sign, sz));
        let near = _mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_andnot_pd(sign, along), bound);
        let on_edge = [u, v, w].map(|x| _mm256_cmp_pd::<_CMP_EQ_OQ>(x, zero));
        let unsure = _mm256_or_pd(_mm256_or_pd(near, on_edge[0]), _mm256_or_pd(on_edge[1], on_edge[2]));
        let ahead = _mm256_cmp_pd::<_CMP_GT_OQ>(t, zero);
        let ahead = _mm256_and_pd(ahead, _mm256_cmp_pd::<_CMP_LE_OQ>(t, _mm256_set1_pd(t_max)));
        let hits = _mm256_andnot_pd(unsure, _mm256_and_pd(inside, ahead));
        let bits = |lanes: __m256d| _mm256_movemask_pd(lanes) as u32;
        // SAFETY: both the vector and the array are four 64-bit numbers.
        let numbers = |lanes: __m256d| unsafe { transmute::<__m256d, [f64; GROUP]>(lanes) };
        Some(Crossings {
            hits: bits(hits),
            unsure: bits(_mm256_and_pd(inside, unsure)),
            t: numbers(t),
            v: numbers(v),
            w: numbers(w),
            determinant: numbers(determinant),
        })
    }
}
