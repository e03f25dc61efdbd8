//! The one place that chooses how many lanes of a basis travel together.

/// Runs work in `N` lanes, the narrowest compiled width that a basis fits into: `in_lanes!(basis, N => work::<N>())`.
macro_rules! in_lanes {
    ($basis:expr, $n:ident => $work:expr) => {
        match $basis.lanes() {
            0..=4 => {
                const $n: usize = 4;
                $work
            }
            5..=16 => {
                const $n: usize = 16;
                $work
            }
            17..=$crate::spectrum::MAX_LANES => {
                const $n: usize = $crate::spectrum::MAX_LANES;
                $work
            }
            lanes => unreachable!("no basis has {lanes} lanes"),
        }
    };
}

/// Runs work in a world's lanes, with the polarization that its paths carry if no Stokes layers are made:
/// `in_lanes_of!(world, N, P => work::<N, P>())`.
macro_rules! in_lanes_of {
    ($world:expr, $n:ident, $p:ident => $work:expr) => {
        match $world.method.polarization {
            $crate::trace::Polarizing::Averaged => $crate::trace::width::in_lanes!($world.method.basis, $n => {
                type $p = $crate::trace::walk::Polarized;
                $work
            }),
            _ => $crate::trace::width::in_lanes!($world.method.basis, $n => {
                type $p = $crate::trace::walk::Rows<$n, 1>;
                $work
            }),
        }
    };
}

/// Runs work in a world's lanes, with the polarization that its layers need:
/// `in_lanes_of_layers!(world, N, P => work::<N, P>())`.
macro_rules! in_lanes_of_layers {
    ($world:expr, $n:ident, $p:ident => $work:expr) => {
        if $world.layers.has_stokes() && $world.method.polarization != $crate::trace::Polarizing::Averaged {
            $crate::trace::width::in_lanes!($world.method.basis, $n => {
                type $p = $crate::trace::walk::Rows<$n, 4>;
                $work
            })
        } else {
            $crate::trace::width::in_lanes_of!($world, $n, $p => $work)
        }
    };
}
pub(super) use in_lanes;
pub(super) use in_lanes_of;
pub(super) use in_lanes_of_layers;
