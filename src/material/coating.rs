use std::cell::RefCell;
use std::ops::Deref;

use super::ScatterContext;
use super::film_averages::FilmAverages;
use super::film_table::FilmTable;
use super::lane_cache::LaneCache;
use super::stack::{Layer, Stack, StackShares};
use crate::math::Complex;
use crate::spectrum::{Lanes, MAX_LANES, Quantity, Table};

/// Thin layers on a surface, in which light interferes: what makes lenses dark, titanium blue and soap colorful.
///
/// Inside the layers and on both sides, waves are summed by Abeles' matrices: see [`Stack`]. On a rough surface, the
/// facets carry the layers (Belcour & Barla 2017, *A Practical Extension to Microfacet Theory for the Modeling of
/// Varying Iridescence*, without its integration over the eye's curves, which the lanes do). Beyond
/// [`COHERENT_NM`](super::COHERENT_NM) a lane gets the mean over all phases; lines and heroes see every fringe.
///
/// Layers do not bend rays, and are flat at the point of the hit. A rough surface between equal indices shows none.
///
/// ```toml
/// coating = [{ index = 1.38, thickness_nm = 99.6 }]     # from the outside inward, at most 32
/// coating = [{ index = 2.4, k = 0.02, thickness_nm = { image = "oxide.png", scale = 150 } }]     # k = 0 if absent
/// coating = [{ metal = "Au", thickness_nm = 12 }]
/// ```
#[derive(Clone, Debug)]
pub struct Coating<S> {
    /// From the outside inward.
    pub layers: Vec<CoatingLayer<S>>,
    /// Averages of the film over directions, from outside and from inside, by the indices around it.
    cached: [LaneCache<[f64; 4], FilmAverages>; 2],
    /// Tables of these averages by thickness, if a single layer varies over the surface.
    by_thickness: [LaneCache<[f64; 4], FilmTable>; 2],
}

/// One layer.
#[derive(Clone, Debug)]
pub struct CoatingLayer<S> {
    /// Refractive index.
    pub index: S,
    /// Extinction coefficient.
    pub k: S,
    /// Whether the layer is metal, with the index and extinction of one.
    pub is_metal: bool,
    /// Thickness in nm.
    pub thickness: S,
}

impl<S> Coating<S> {
    /// Makes a coating from layers in order from the outside inward.
    pub fn new(layers: Vec<CoatingLayer<S>>) -> Self {
        let cached = [LaneCache::new(), LaneCache::new()];
        Self { layers, cached, by_thickness: [LaneCache::new(), LaneCache::new()] }
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Coating<T> {
        let layer = |layer: &CoatingLayer<S>| CoatingLayer {
            index: convert(if layer.is_metal { Quantity::MetalIndex } else { Quantity::Index }, &layer.index),
            k: convert(Quantity::MetalExtinction, &layer.k),
            is_metal: layer.is_metal,
            thickness: convert(Quantity::Thickness, &layer.thickness),
        };
        Coating::new(self.layers.iter().map(layer).collect())
    }
}

impl Coating<Table> {
    /// Returns whether no layer absorbs.
    pub(super) fn is_clear(&self) -> bool {
        self.layers.iter().all(|layer| layer.k.is_flat() && layer.k.bins()[0] == 0.0)
    }

    /// Returns the coating at the point where light arrives; `inside` selects its inner side.
    pub(super) fn local<'a, const N: usize>(
        &'a self,
        context: &'a ScatterContext<'a, N>,
        inside: bool,
    ) -> LocalCoating<'a, N> {
        let read = |layer: &CoatingLayer<Table>| context.read(&layer.thickness);
        let mut varying_layers = (0..self.layers.len()).filter(|&number| self.layers[number].thickness.varies());
        let first = varying_layers.next();
        let thicknesses = if first.is_none() { Vec::new() } else { self.layers.iter().map(read).collect() };
        let varying = first.filter(|_| varying_layers.next().is_none());
        LocalCoating { coating: self, context, inside, thicknesses, varying }
    }
}

/// A result of [`Stack::shares`], and what it was computed for.
struct CachedShares {
    /// The indices on both sides, and the cosine times the first.
    boundary: [f64; 4],
    stack: Stack,
    shares: StackShares,
}

/// The last two results for a lane: a coat is crossed in two directions, one of which stays the same.
struct RecentShares {
    entries: [Option<CachedShares>; 2],
    newest: usize,
}

thread_local! {
    static SHARES_CACHE: RefCell<[RecentShares; MAX_LANES]> =
        const { RefCell::new([const { RecentShares { entries: [const { None }; 2], newest: 0 } }; MAX_LANES]) };
}

/// Averages of a film over directions, borrowed or boxed, since they are too large to copy.
pub(super) enum Averages<'a> {
    /// Averages that are equal everywhere.
    Cached(&'a FilmAverages),
    /// Averages for one place or one sample.
    Computed(Box<FilmAverages>),
}

impl Deref for Averages<'_> {
    type Target = FilmAverages;

    fn deref(&self) -> &FilmAverages {
        match self {
            Self::Cached(averages) => averages,
            Self::Computed(averages) => averages,
        }
    }
}

/// A coating at the point where light arrives.
pub(super) struct LocalCoating<'a, const N: usize> {
    coating: &'a Coating<Table>,
    context: &'a ScatterContext<'a, N>,
    /// Whether it is hit from inside.
    pub(super) inside: bool,
    /// Thicknesses of each layer, if any layer varies over the surface.
    thicknesses: Vec<Lanes<N>>,
    /// The only layer that varies, if it is a single one.
    varying: Option<usize>,
}

impl<'a, const N: usize> LocalCoating<'a, N> {
    /// Returns the averages of a film over directions, between `indices`. They are computed once if they are equal
    /// everywhere and in every sample, and read from a table if the thickness of a single layer varies. `inside`
    /// selects light that comes from inside.
    pub(super) fn averages(
        &self,
        lane: usize,
        inside: bool,
        indices: [f64; 4],
        make: impl Fn(&Stack) -> FilmAverages,
    ) -> Averages<'a> {
        let Self { coating, context: ScatterContext { draw, .. }, .. } = self;
        let make_here = || make(&self.stack(lane));
        let side = usize::from(inside);
        if self.thicknesses.is_empty() {
            let cached = coating.cached[side].get(draw, lane, indices, make_here);
            return cached.map_or_else(|| Averages::Computed(Box::new(make_here())), Averages::Cached);
        }
        let read = || {
            let number = self.varying?;
            let layer = self.layer(number, lane);
            let new = || FilmTable::new(&layer, self.context.wave(lane)[0], coating.layers[number].thickness.range().1);
            let table = coating.by_thickness[side].get(draw, lane, indices, new)?;
            table.read(layer.thickness_nm, |thickness_nm| {
                let layers = self.layer_numbers().map(|at| match self.layer(at, lane) {
                    layer if at == number => Layer { thickness_nm, ..layer },
                    layer => layer,
                });
                make(&Stack::new(self.context.wave(lane), layers))
            })
        };
        Averages::Computed(Box::new(read().unwrap_or_else(make_here)))
    }

    /// Returns what the layers do to a lane between index `n1` and `n2` beyond: [`Stack::shares`].
    ///
    /// Results are cached, since a surface needs them up to four times: for light that passes straight through, for
    /// mirrored light, and for the polarization of each.
    pub(super) fn shares(&self, lane: usize, n1: f64, n2: Complex, q1: f64) -> StackShares {
        let boundary = [n1, n2.re, n2.im, q1];
        SHARES_CACHE.with_borrow_mut(|last| {
            let RecentShares { entries, newest } = &mut last[lane];
            let matches = |entry: &&CachedShares| {
                entry.boundary == boundary && entry.stack.is(self.context.wave(lane), self.layers(lane))
            };
            let cached = |place: usize| Some((place, entries[place].as_ref().filter(matches)?.shares));
            if let Some((place, shares)) = cached(0).or_else(|| cached(1)) {
                *newest = place;
                return shares;
            }
            let stack = self.stack(lane);
            let shares = stack.shares(n1, n2, q1);
            *newest = 1 - *newest;
            entries[*newest] = Some(CachedShares { boundary, stack, shares });
            shares
        })
    }

    /// Returns the shares of light that meets the layers at an angle with cosine `cos`.
    pub(super) fn shares_at_cosine(&self, lane: usize, n1: f64, n2: impl Into<Complex>, cos: f64) -> StackShares {
        self.shares(lane, n1, n2.into(), n1 * cos.clamp(0.0, 1.0))
    }

    /// Returns the layers for a lane, the viewer's side first.
    pub(super) fn stack(&self, lane: usize) -> Stack {
        Stack::new(self.context.wave(lane), self.layers(lane))
    }

    fn layers(&self, lane: usize) -> impl Iterator<Item = Layer> {
        self.layer_numbers().map(move |number| self.layer(number, lane))
    }

    /// Returns the numbers of the layers, the viewer's side first.
    fn layer_numbers(&self) -> impl Iterator<Item = usize> {
        let count = self.coating.layers.len();
        (0..count).map(move |place| if self.inside { count - 1 - place } else { place })
    }

    fn layer(&self, number: usize, lane: usize) -> Layer {
        let layer = &self.coating.layers[number];
        let read = |table| self.context.draw.read_lane(table, lane);
        let thickness_nm = match self.thicknesses.get(number) {
            Some(thickness) => f64::from(thickness[lane]),
            None => read(&layer.thickness),
        };
        Layer { index: Complex::new(read(&layer.index), -read(&layer.k)), thickness_nm }
    }
}
