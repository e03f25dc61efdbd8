use super::last_result::LastResult;
use super::polarization_degree::{combined_degree, degree, max_degree};
use super::{Block, Branch, Coating, Interface, Mueller, ScatterContext, StackShares, Straight, conductor_reflectance};
use crate::spectrum::{Draw, LaneSet, Lanes, Quantity, Table};

/// A sheet that does not bend light. Light is mirrored or passes straight through. Lights are sampled through the sheet
/// as well.
///
/// ```toml
/// thin = { index = 1.52 }     # transmittance = 1: what is left after one way through the pane, straight on
/// thin = { index = 1.33, thickness_nm = 400 }     # a film in which light interferes; k = 0 if absent
/// thin = { index = 1.33, thickness_nm = { image = "bubble.png", scale = 600 } }
/// thin = { metal = "Au", thickness_nm = 100 }     # gold leaf
/// ```
#[derive(Clone, Debug)]
pub enum Thin<S> {
    /// A window reduced to its two surfaces. All reflections between them are summed.
    Pane {
        /// Refractive index.
        index: S,
        /// Share of the light that is left after one way through the pane, equal at every angle.
        transmittance: S,
    },
    /// One layer with a thickness: a soap film, a flake of mica, gold leaf. The reflections at its two surfaces
    /// interfere, and its extinction coefficient determines what it absorbs.
    Film(Coating<S>),
}

impl<S> Thin<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Thin<T> {
        match self {
            Self::Pane { index, transmittance } => Thin::Pane {
                index: convert(Quantity::Index, index),
                transmittance: convert(Quantity::Transmittance, transmittance),
            },
            Self::Film(film) => Thin::Film(film.map(convert)),
        }
    }

    /// Returns its index, if it is clear.
    pub(super) fn clear_index(&self) -> Option<&S> {
        match self {
            Self::Pane { index, .. } => Some(index),
            Self::Film(film) => film.layers.first().filter(|layer| !layer.is_metal).map(|layer| &layer.index),
        }
    }

    /// Returns the share of light that its substance transmits, apart from reflection at its surfaces, if it is given.
    pub fn transmittance(&self) -> Option<&S> {
        match self {
            Self::Pane { transmittance, .. } => Some(transmittance),
            Self::Film(_) => None,
        }
    }
}

impl Thin<Table> {
    /// Estimates the reflectance of one of its two surfaces for a lane, in a medium of index `here` at an angle with
    /// cosine `cos`. A clear film is taken without interference, a metal as if it were thick.
    pub fn reflectance_of_one_surface<const N: usize>(&self, draw: &Draw<N>, lane: usize, here: f64, cos: f64) -> f64 {
        let read = |table| draw.read_lane(table, lane);
        match self {
            Self::Film(Coating { layers, .. }) if layers[0].is_metal => {
                let [s, p] = conductor_reflectance(here, read(&layers[0].index), read(&layers[0].k), cos);
                0.5 * (s + p)
            }
            Self::Film(Coating { layers, .. }) => Interface::new(here, read(&layers[0].index), cos).reflectance,
            Self::Pane { index, .. } => Interface::new(here, read(index), cos).reflectance,
        }
    }

    /// Returns the share that passes straight through.
    pub(super) fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Straight<N> {
        let (panes, polarization) = self.share(context, true);
        Straight { holes: Lanes::ZERO, panes, polarization }
    }

    /// Adds the mirrored branch.
    pub(super) fn scatter<const N: usize>(&self, context: &ScatterContext<N>, branches: &mut Vec<Branch<N>>) {
        let (share, polarization) = self.share(context, false);
        if !share.is_zero() {
            branches.push(Branch::mirrored(context, share, polarization));
        }
    }

    /// Sets the Mueller matrix of some lanes, for light that crosses the pane or is mirrored.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        crosses: bool,
        lanes: LaneSet,
        mueller: &mut Mueller<N>,
    ) {
        let (axis, cos) = (context.wo.cross(context.normal), context.wo.dot(context.normal));
        let (index, transmittance) = match self {
            Self::Pane { index, transmittance } => (index, transmittance),
            Self::Film(film) => {
                let film = film.local(context, false);
                return mueller.set_lanes(axis, lanes, |lane| {
                    let n = context.incident_of(lane);
                    let StackShares { reflected, refracted } = film.shares_at_cosine(lane, n, n, cos);
                    if crosses { refracted.block() } else { reflected.block() }
                });
            }
        };
        let (index, left) = (context.draw.read_exact(index), context.read(transmittance));
        let mut last = LastResult::NONE;
        mueller.set_lanes(axis, lanes, |lane| {
            let pane @ [n1, n2, t] = [context.incident_of(lane), index[lane], f64::from(left[lane])];
            if n1 == n2 {
                return if crosses { Block::IDENTITY.times(t) } else { Block::default() };
            }
            let [through, back] = last.get_or_make(pane, |[n1, n2, t]| {
                Block::of_pane(Block::reflected(n1, n2, cos), Block::refracted(n1, n2, cos), t)
            });
            if crosses { through } else { back }
        });
    }

    /// Returns the share of each lane that passes straight through or is mirrored, and the largest degree to which
    /// unpolarized light becomes polarized; for a film with interference, the degree of all lanes together.
    fn share<const N: usize>(&self, context: &ScatterContext<N>, crosses: bool) -> (Lanes<N>, f32) {
        let cos = context.wo.dot(context.normal);
        let mut lanes = [[0.0; 2]; N];
        let present = (0..N).filter(|&lane| context.present[lane] != 0.0);
        let mean = |lanes: &[[f64; 2]; N]| Lanes::from_fn(|lane| (0.5 * (lanes[lane][0] + lanes[lane][1])) as f32);
        match self {
            Self::Pane { index, transmittance } => {
                let (index, left) = (context.draw.read_exact(index), context.read(transmittance));
                let mut last = LastResult::NONE;
                for lane in present {
                    let pane = [context.incident_of(lane), index[lane], f64::from(left[lane])];
                    let [through, back] =
                        last.get_or_make(pane, |[n1, n2, t]| pane_shares(&Interface::new(n1, n2, cos), t));
                    lanes[lane] = if crosses { through } else { back };
                }
                (mean(&lanes), max_degree(lanes.into_iter().map(degree)))
            }
            Self::Film(film) => {
                let film = film.local(context, false);
                for lane in present {
                    let n = context.incident_of(lane);
                    let StackShares { reflected, refracted } = film.shares_at_cosine(lane, n, n, cos);
                    let share = if crosses { refracted } else { reflected };
                    lanes[lane] = [share.s, share.p];
                }
                (mean(&lanes), combined_degree(lanes.into_iter()) as f32)
            }
        }
    }
}

/// Returns the transmittance and the reflectance of a pane, each as (s, p), if the share `t` is left after one way
/// through it.
///
/// With R of one surface, T = (1 - R)^2 t / (1 - R^2 t^2), and the pane reflects R + R t T (Stokes 1862, *On the
/// Intensity of the Light Reflected from or Transmitted through a Pile of Plates*). All surfaces share one plane of
/// incidence, so that s and p do not mix: each has its own series, and unpolarized light gets the mean of both.
fn pane_shares(surface: &Interface, t: f64) -> [[f64; 2]; 2] {
    let [s, p] = [1.0, -1.0].map(|sign| {
        let r = surface.reflectance * (1.0 + sign * surface.polarization_reflected);
        let crosses = surface.transmittance * (1.0 + sign * surface.polarization_refracted);
        // 1 - R t as a sum of two nonnegative numbers; 0 only where no light enters at all.
        let denominator = crosses + r * (1.0 - t);
        let through = if crosses > 0.0 { crosses * crosses * t / (denominator * (1.0 + r * t)) } else { 0.0 };
        [through, r + r * t * through]
    });
    [[s[0], p[0]], [s[1], p[1]]]
}
