use super::degree::{degree, largest, of_all_lanes};
use super::last::Last;
use super::{Arrival, Block, Branch, Coating, Interface, Mueller, StackShares, Straight};
use crate::spectrum::{LaneSet, Lanes, Quantity, Table};

/// A pane of clear material without thickness: a window of which nothing but its two surfaces is seen. Light goes
/// straight on, that of lights to the surfaces behind as well, or is mirrored; all reflections between the two surfaces
/// are summed.
///
/// ```toml
/// thin = { index = 1.52 }     # transmittance = 1: what is left after one way through the pane, straight on
/// thin = { index = 1.33, thickness_nm = 400 }     # a film in which light interferes; k = 0 if absent
/// thin = { index = 1.33, thickness_nm = { image = "bubble.png", scale = 600 } }
/// ```
///
/// With a thickness it is a soap film or a flake of mica: light that is reflected by its two surfaces interferes, and
/// what it absorbs is by its extinction `k`.
#[derive(Clone, Debug)]
pub struct Thin<S> {
    /// Refractive index.
    pub index: S,
    /// Share of the light that is left after one way through the pane, at every angle.
    pub transmittance: S,
    /// The pane as a layer in which light interferes, if it has a thickness.
    pub film: Option<Coating<S>>,
}

impl<S> Thin<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Thin<T> {
        Thin {
            index: convert(Quantity::Index, &self.index),
            transmittance: convert(Quantity::Transmittance, &self.transmittance),
            film: self.film.as_ref().map(|film| film.map(convert)),
        }
    }
}

impl Thin<Table> {
    /// What goes straight on.
    pub(super) fn straight<const N: usize>(&self, arrival: &Arrival<N>) -> Straight<N> {
        let (panes, polarization) = self.share(arrival, true);
        Straight { holes: Lanes::ZERO, panes, polarization }
    }

    /// What is mirrored.
    pub(super) fn scatter<const N: usize>(&self, arrival: &Arrival<N>, branches: &mut Vec<Branch<N>>) {
        let (share, polarization) = self.share(arrival, false);
        if !share.is_zero() {
            branches.push(Branch::mirrored(arrival, share, polarization));
        }
    }

    /// What becomes of polarization in some lanes, of light that crosses the pane or is mirrored.
    pub(super) fn mueller<const N: usize>(
        &self,
        arrival: &Arrival<N>,
        crosses: bool,
        lanes: LaneSet,
        mueller: &mut Mueller<N>,
    ) {
        let (index, left) = (arrival.draw.read_exact(&self.index), arrival.read(&self.transmittance));
        let (axis, cos) = (arrival.wo.cross(arrival.normal), arrival.wo.dot(arrival.normal));
        let mut last = Last::NONE;
        let film = self.film.as_ref().map(|film| film.met(arrival, false));
        mueller.set_lanes(axis, lanes, |lane| {
            if let Some(film) = &film {
                let n = arrival.incident_of(lane);
                let StackShares { reflected, refracted } = film.at_cosine(lane, n, n, cos);
                return if crosses { refracted.block() } else { reflected.block() };
            }
            let pane @ [n1, n2, t] = [arrival.incident_of(lane), index[lane], f64::from(left[lane])];
            if n1 == n2 {
                return if crosses { Block::IDENTITY.times(t) } else { Block::default() };
            }
            let [through, back] = last.of(pane, |[n1, n2, t]| {
                Block::of_pane(Block::reflected(n1, n2, cos), Block::refracted(n1, n2, cos), t)
            });
            if crosses { through } else { back }
        });
    }

    /// What of each lane goes straight on, or is mirrored, and the largest degree of polarization that this gives to
    /// unpolarized light; of a film, in which light interferes, that of all lanes together.
    fn share<const N: usize>(&self, arrival: &Arrival<N>, crosses: bool) -> (Lanes<N>, f32) {
        let (index, left) = (arrival.draw.read_exact(&self.index), arrival.read(&self.transmittance));
        let film = self.film.as_ref().map(|film| film.met(arrival, false));
        let (cos, mut last) = (arrival.wo.dot(arrival.normal), Last::NONE);
        let mut lanes = [[0.0; 2]; N];
        for lane in (0..N).filter(|&lane| arrival.present[lane] != 0.0) {
            let (n1, t) = (arrival.incident_of(lane), f64::from(left[lane]));
            let [through, back] = match &film {
                Some(film) => {
                    let StackShares { reflected, refracted } = film.at_cosine(lane, n1, n1, cos);
                    [refracted, reflected].map(|share| [share.s, share.p])
                }
                None if index[lane] == n1 => [[t; 2], [0.0; 2]],
                None => last.of([n1, index[lane], t], |[n1, n2, t]| all_reflections(&Interface::new(n1, n2, cos), t)),
            };
            lanes[lane] = if crosses { through } else { back };
        }
        let share = Lanes::from_fn(|lane| (0.5 * (lanes[lane][0] + lanes[lane][1])) as f32);
        let lanes = lanes.into_iter();
        (share, if film.is_some() { of_all_lanes(lanes) as f32 } else { largest(lanes.map(degree)) })
    }
}

/// What goes through a pane and what comes back, each (s, p), of which one way leaves the share `t`.
///
/// With R of one surface T = (1 - R)^2 t / (1 - R^2 t^2), and R + R t T comes back (Stokes 1862, *On the Intensity of
/// the Light Reflected from or Transmitted through a Pile of Plates*). All surfaces share one plane of incidence, so
/// that s and p keep to themselves: each has its own series, and unpolarized light has the mean of both.
fn all_reflections(surface: &Interface, t: f64) -> [[f64; 2]; 2] {
    let [s, p] = [1.0, -1.0].map(|sign| {
        let r = surface.reflectance * (1.0 + sign * surface.polarization_reflected);
        let crosses = surface.transmittance * (1.0 + sign * surface.polarization_refracted);
        // 1 - R t as a sum of two numbers that are not negative; 0 only where no light enters at all.
        let left = crosses + r * (1.0 - t);
        let through = if crosses > 0.0 { crosses * crosses * t / (left * (1.0 + r * t)) } else { 0.0 };
        [through, r + r * t * through]
    });
    [[s[0], p[0]], [s[1], p[1]]]
}
