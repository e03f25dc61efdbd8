//! Photons: light followed forward over smooth surfaces, to where the camera sees it.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::light::{LeSample, LightId};
use crate::material::{Arrival, Branch, Material, Scatter};
use crate::math::{DVec2, DVec3, Frame, Ray, Sampler, cosine_hemisphere, unit};
use crate::scene::{Ends, FilmSettings, Seen, Sight};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes};
use crate::trace::World;
use crate::trace::arrived::Arrived;
use crate::trace::dyes::Dyes;
use crate::trace::first_lobe::FirstLobe;
use crate::trace::media::Media;
use crate::trace::spectrum_sample::Spectrum;
use crate::trace::walk::{
    DYE, Departure, Interaction, Onward, Passage, Past, Path, PathKind, Polarization, Polarized, SeenPhoton, Walker,
    parts, shading,
};

/// Use of the random numbers where a photon is seen: the point of the lens.
const LENS: u32 = 3;

/// What a photon adds to a pixel of the window.
#[derive(Clone, Debug)]
pub struct Splat {
    pub pixel: u32,
    /// By what share polarization may change it.
    pub change: f32,
    pub rgb: [f64; 3],
    /// S1, S2 and S3 if they are asked for, times a factor.
    pub stokes: Option<Arc<[[f64; 3]; 3]>>,
    /// What it adds to the numbers of a spectral image if one is asked for, times a factor.
    pub bands: Option<Arc<[f32]>>,
    pub weight: f64,
    pub light: LightId,
    /// Whether its wavelengths parted on the way.
    pub dispersed: bool,
    /// Whether the photon is of the first half of those sent with it.
    pub early: bool,
    /// Whether it landed on a shadow catcher.
    pub caught: bool,
    /// By which lobe that surface sends it to the camera, if layers tell that apart.
    pub first: Option<FirstLobe>,
}

impl Splat {
    /// So many times as bright.
    pub fn times(self, factor: f64) -> Self {
        Self { rgb: self.rgb.map(|x| x * factor), weight: self.weight * factor, ..self }
    }

    /// The same of a photon of the first half or not, if that is said.
    pub fn of_half(self, early: Option<bool>) -> Self {
        Self { early: early.unwrap_or(self.early), ..self }
    }
}

/// Where a photon lands, and the light's way there.
pub struct Landing<'a, const N: usize, P = Polarized> {
    pub path: &'a Path<N, P>,
    pub at: &'a Interaction<'a, N>,
    pub light: LightId,
    /// How it left the light, with its flux per emission.
    emitted: &'a LeSample,
    /// Whether the photon is of the first half of those sent with it.
    early: bool,
}

impl<const N: usize, P> Landing<'_, N, P> {
    /// What the light shines on the photon's way, per emission.
    fn shone(&self, world: &World) -> Lanes<N> {
        world.scene.lights[self.light].toward(self.at.arrival.draw, -self.emitted.ray.direction, self.emitted.uv())
    }

    /// What the photon brings: its flux, lane by lane.
    pub fn flux(&self, world: &World) -> Lanes<N> {
        self.path.throughput.scaled(self.emitted.factor / self.path.eta_scale).of(self.shone(world))
    }
}

/// Which surfaces a photon goes on from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// Smooth ones. The first must be one that photons are sent to: paths by way of others are left to the camera's
    /// rays.
    Smooth,
    /// All.
    All,
    /// All, but light that starts toward an object to which its photons are sent is left to those.
    AllButPhotons,
}

/// How a photon starts.
pub struct Start<'a> {
    pub emitted: &'a LeSample,
    pub light: LightId,
    pub media: Media,
    /// Whether the photon is of the first half of those sent with it.
    pub early: bool,
}

/// Follows a photon over surfaces; `land` is told where it lands on those that scatter widely.
///
/// Throughput is followed as if the light were the viewer; flux is what is left of it without the factor of radiance
/// between media.
pub fn follow_photon<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    start: Start,
    draw: &Draw<N>,
    sampler: &Sampler,
    over: Surfaces,
    land: &mut dyn FnMut(&Walker<N, P>, &Landing<N, P>),
) {
    let path = Path::from_light(walker.world, draw, start.emitted.ray, start.media);
    *walker.pending.add(|| path) = path;
    while let Some(mut path) = walker.pending.take() {
        advance(walker, &mut path, &start, draw, sampler, over, land);
        walker.pending.release(path);
    }
}

/// Follows a photon to the next surface.
#[inline(always)]
fn advance<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &mut Path<N, P>,
    &Start { emitted, light, early, .. }: &Start,
    draw: &Draw<N>,
    sampler: &Sampler,
    over: Surfaces,
    land: &mut dyn FnMut(&Walker<N, P>, &Landing<N, P>),
) {
    let world = walker.world;
    if path.vertices >= walker.transport.last_vertex() {
        return;
    }
    let Some(meeting) = walker.meet(path, draw) else { return };
    if let Some(onward) = walker.straight(path, draw, &meeting)
        && passes(walker, path, draw, sampler, &meeting.point, &onward)
    {
        return;
    }
    if path.vertices == 0 {
        let is_target = world.is_photon_target(meeting.hit.object);
        match over {
            Surfaces::Smooth if !is_target => return,
            Surfaces::AllButPhotons if is_target && world.sends_photons(light) => return,
            Surfaces::All | Surfaces::AllButPhotons if !is_target => path.kind = PathKind::Wide,
            _ => {}
        }
    }
    let boundary = match walker.boundary(path, &meeting) {
        Ok(boundary) => boundary,
        Err(hidden) => return walker.go_on_past(path, &meeting, &hidden),
    };
    path.vertices += 1;
    if over != Surfaces::Smooth && world.ends_light_paths(meeting.hit.object) {
        return;
    }
    let at = Interaction::new(world, draw, &path.arriving(), &meeting, boundary);
    if over != Surfaces::Smooth && path.surfaces() == 1 && (path.hidden > 0 || !at.lobes.is_diffuse()) {
        // From the camera, a path has to leave the next diffuse surface to reach this one, or a light that a hidden
        // surface keeps from being sampled. It leaves none for a light.
        path.diffuse_left = path.diffuse_left.saturating_sub(1);
    }
    // As often as light may leave surfaces on its way from the camera.
    let allowed = path.surfaces() <= world.method.max_bounces && !(at.lobes.is_diffuse() && path.diffuse_left == 0);
    let shown = over != Surfaces::Smooth || path.vertices > 1;
    if at.lobes.is_wide() && allowed && shown {
        land(walker, &Landing { path, at: &at, light, emitted, early });
    }
    if over == Surfaces::Smooth || !at.lobes.is_wide() {
        bounce(walker, path, at, sampler);
    } else if allowed && path.surfaces() < world.method.max_bounces {
        scatter(walker, path, &at, sampler);
    }
}

/// Lets a photon go straight on, and answers whether it does not meet the surface as well. One that carries little does
/// one or the other: each of a stack of panes would double the photons that it mirrors.
#[cold]
fn passes<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &mut Path<N, P>,
    draw: &Draw<N>,
    sampler: &Sampler,
    point: &SurfacePoint,
    onward: &Onward<N, P>,
) -> bool {
    let (throughput, key) = (path.throughput.through(onward.straight.share()), path.key.child(BEYOND));
    let beyond = Path { throughput, key, polarization: onward.polarization, ..path.passed(point) };
    let all = throughput == path.throughput;
    if all || walker.follows_all(path, draw) {
        *walker.pending.add(|| *path) = beyond;
        return all;
    }
    let shares = draw.shares(path.parted);
    let share = throughput.weight(shares) / path.throughput.weight(shares);
    if sampler.four_plain(path.key, STRAIGHT)[0] < share {
        *walker.pending.add(|| *path) = Path { throughput: throughput.scaled(1.0 / share), ..beyond };
        return true;
    }
    path.throughput = path.throughput.scaled(1.0 / (1.0 - share));
    false
}

/// Lets a photon go on from a surface that scatters widely, with the share that the camera would see of the way back.
fn scatter<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &Path<N, P>,
    at: &Interaction<N>,
    sampler: &Sampler,
) {
    let Interaction { material, point, arrival, flat, .. } = at;
    let u = sampler.four(path.key, SCATTER);
    walker.branches.clear();
    if point.shading == point.normal {
        material.scatter(arrival, [u[0], u[1]], &mut walker.branches);
        walker.polarize(path, at);
        if !matches!(material, Material::Diffuse(_)) {
            walker.branches.iter_mut().filter(|branch| branch.pdf.is_some()).for_each(|branch| turn_back(at, branch));
        }
        send_forward(arrival, &mut walker.branches);
    } else {
        // By shading normals that depend on the viewer, not every direction is drawn from which light arrives.
        let local = cosine_hemisphere([u[0], u[1]]);
        let wi = unit(Frame::about(*flat).to_world(local));
        let share = seen_from(at, wi).map(|bsdf_cos| bsdf_cos * (PI / arrival.wo.dot(*flat)) as f32);
        let wide =
            |share| Branch { wi, share, pdf: Some(local.z / PI), crosses: false, eta_scale: 1.0, polarization: 0.0 };
        walker.branches.extend(share.map(wide));
        walker.polarize(path, at);
    }
    walker.follow(&mut Departure::new(walker.world, path, at).of_light_path(), sampler);
}

/// What the camera would see of a photon in the direction in which it leaves, times the cosine of its arrival.
fn seen_from<const N: usize>(at: &Interaction<N>, direction: DVec3) -> Option<Lanes<N>> {
    let [side, normal] = shading::normals(at.point, direction);
    let viewed = Arrival { wo: direction, normal, ..at.arrival };
    shading::evaluate(at.material, &viewed, side, at.arrival.wo).map(|(bsdf_cos, _)| bsdf_cos)
}

/// Replaces the share of a branch by that of light the other way: materials need not answer alike to both.
fn turn_back<const N: usize>(at: &Interaction<N>, branch: &mut Branch<N>) {
    let onward = shading::evaluate(at.material, &at.arrival, at.flat, branch.wi);
    let (Some((onward, _)), Some(back)) = (onward, seen_from(at, branch.wi)) else {
        branch.share = Lanes::ZERO;
        return;
    };
    let cosines = (branch.wi.dot(at.flat) / at.arrival.wo.dot(at.flat)).abs() as f32;
    let ratio = |i: usize| if onward[i] == 0.0 { 0.0 } else { back[i] * cosines / onward[i] };
    branch.share = branch.share * Lanes::from_fn(ratio);
}

/// Lets a photon go on over a smooth surface.
fn bounce<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &Path<N, P>,
    at: Interaction<N>,
    sampler: &Sampler,
) {
    let plain = shading::plain_normal(at.point, at.arrival.wo);
    let at = at.by_normal(plain);
    let Interaction { material, point, arrival, .. } = &at;
    let goes_on = at.lobes.has_delta() && arrival.wo.dot(arrival.normal) > 0.0;
    if !goes_on || path.surfaces() >= walker.world.method.max_bounces {
        return;
    }
    walker.branches.clear();
    let u = sampler.four_plain(path.key, SCATTER);
    material.scatter(arrival, [u[0], u[1]], &mut walker.branches);
    let back = arrival.wo;
    walker.branches.retain(|branch| branch.pdf.is_none() && shading::is_plain(point, branch.wi, back, branch.crosses));
    walker.polarize(path, &at);
    for branch in &mut walker.branches {
        branch.share = branch.share * shading::forward_factor(point, branch.wi, back) as f32;
    }
    send_forward(arrival, &mut walker.branches);
    walker.follow(&mut Departure::new(walker.world, path, &at), sampler);
}

/// Makes shares of radiance that cross a smooth surface shares of flux.
fn send_forward<const N: usize>(arrival: &Arrival<N>, branches: &mut [Branch<N>]) {
    if let Some(forward) = arrival.forward() {
        branches.iter_mut().filter(|branch| branch.crosses).for_each(|branch| branch.share = branch.share * forward);
    }
}

/// How the camera sees the place where a photon has landed.
struct View<'v, 'a, const N: usize, P: Polarization<N>> {
    walker: &'v Walker<'a, N, P>,
    landing: &'v Landing<'v, N, P>,
    sampler: &'v Sampler,
    seen: Seen,
    /// Where on the film, near enough to the window.
    places: Vec<DVec2>,
    /// Whether the camera is on the side where the photon has arrived; the surface as it sees it, and its own unit
    /// normal there.
    same: bool,
    viewed: Arrival<'v, N>,
    side: DVec3,
    sight: Sight,
}

/// Adds what the camera sees of a photon.
pub fn show<const N: usize, P: Polarization<N>>(
    walker: &Walker<N, P>,
    landing: &Landing<N, P>,
    sampler: &Sampler,
    splats: &mut Vec<Splat>,
) {
    let Some(view) = View::new(walker, landing, sampler) else { return };
    view.spread(view.scattered(), splats);
    if let Some(dyes) = &walker.world.dyes {
        for (number, dye) in dyes.of(&walker.world.scene, landing.at.object).enumerate() {
            view.spread(view.shone_by(dyes, dye, number), splats);
        }
    }
}

impl<'v, 'a, const N: usize, P: Polarization<N>> View<'v, 'a, N, P> {
    /// None where the camera does not see the place.
    fn new(walker: &'v Walker<'a, N, P>, landing: &'v Landing<'v, N, P>, sampler: &'v Sampler) -> Option<Self> {
        let Landing { path, at, .. } = landing;
        let Interaction { arrival, flat, point, .. } = at;
        let world = walker.world;
        let (camera, film) = (&world.scene.camera, world.scene.film);
        let sight = world.sight(at.object);
        if matches!(sight, Sight::Hidden | Sight::Holdout) {
            return None;
        }
        let u = if camera.has_lens() { sampler.four_plain(path.key, LENS) } else { [0.5; 4] };
        let seen = camera.see(point.position, [u[0], u[1]])?;
        let (window, reach) = (film.window(), film.filter.reach());
        let mut places = camera.places(seen.film, reach + f64::from(film.overscan.widest()));
        let [first, end] = window.ends().map(|place| place.map(|x| x as f64));
        let near = |x: f64, axis: usize| x >= first[axis] - reach && x <= end[axis] + reach;
        places.retain(|place| near(place.x, 0) && near(place.y, 1));
        if places.is_empty() {
            return None;
        }
        let same = seen.direction.dot(*flat) > 0.0;
        let [side, normal] = shading::normals(point, seen.direction);
        let turned = Arrival { wo: seen.direction, normal, ..*arrival };
        let viewed = if same { turned } else { turned.turned_around() };
        Some(Self { walker, landing, sampler, seen, places, same, viewed, side, sight })
    }

    /// What of light reaches the camera that leaves the place toward it, and how it is polarized on its way.
    fn arriving(
        &self,
        draw: &Draw<N>,
        start: impl FnOnce() -> P,
        light: impl FnOnce() -> Lanes<N>,
    ) -> Option<(Lanes<N>, P)> {
        let Landing { path, at, .. } = self.landing;
        let ray = at.point.leave(self.seen.direction);
        let distance = (self.seen.start - ray.origin).length();
        let world = self.walker.world;
        let inside = match world.hides_objects && world.has_media {
            true => world.seen_media(&ray).inside(&world.scene),
            false => at.boundary.sides()[usize::from(!self.same)],
        };
        let ends = Ends { left: path.left, ..Ends::default() };
        let last_occluder = &self.walker.last_occluder;
        let passage = Passage { ray: &ray, distance, ends, inside, past: Past::Seen, last_occluder };
        passage.arriving(world, draw, start, light)
    }

    /// The ray of the camera that sees the place.
    fn back(&self) -> Ray {
        Ray { origin: self.seen.start, direction: -self.seen.direction }
    }

    /// What the pixels get of light that leaves the place toward the camera.
    fn factor(&self) -> f64 {
        let Interaction { arrival, flat, .. } = self.landing.at;
        let cosines = self.seen.direction.dot(*flat).abs() / arrival.wo.dot(*flat).abs();
        let filter = self.walker.world.scene.camera.filter();
        self.landing.emitted.factor
            * cosines
            * self.seen.importance
            * filter.map_or(1.0, |filter| filter.transmittance())
    }

    /// What the surface scatters toward the camera.
    fn scattered(&self) -> Option<Splat> {
        let Self { landing, viewed, side, same, .. } = self;
        let Landing { path, at, light, .. } = landing;
        let Interaction { arrival, material, .. } = at;
        let world = self.walker.world;
        let (mut bsdf_cos, _) = shading::evaluate(material, viewed, *side, arrival.wo)?;
        let parted = path.parted || (!same && parts(at.lobes, material, viewed));
        let start = || path.polarization.shown(at, self.seen.direction, &mut bsdf_cos);
        let (shone, on_its_way) = self.arriving(arrival.draw, start, || landing.shone(world))?;
        let polarized = path.polarization.seen(at, viewed, &on_its_way, world, &self.back());
        let arriving = polarized.factor.map_or(bsdf_cos * shone, |factor| bsdf_cos * shone * factor);
        let lanes = &path.throughput.scaled(1.0 / path.eta_scale).of(arriving);
        let reflected = || FirstLobe::reflected(world.layers.white.as_ref(), material, at.lobes, viewed, arrival.wo);
        let lobe = || if *same { reflected() } else { FirstLobe::Transmitted };
        let first = world.layers.tell_lobes_apart().then(lobe);
        let arrived = Arrived { source: *light, draw: arrival.draw, lanes, parted };
        Some(self.splat(&arrived, &polarized, parted, first))
    }

    /// What a dye, one of its material by a number, shines toward the camera.
    fn shone_by(&self, dyes: &Dyes, dye: usize, number: usize) -> Option<Splat> {
        let Self { landing, viewed, side, .. } = self;
        let Landing { path, at, light, .. } = landing;
        let world = self.walker.world;
        if !self.same {
            return None;
        }
        let (bsdf_cos, _) = shading::evaluate(&dyes.white, viewed, *side, at.arrival.wo)?;
        let lanes = &path.throughput.scaled(1.0 / path.eta_scale).of(bsdf_cos * landing.shone(world));
        let parted = path.parted;
        let brightness = dyes.excited(dye, &Arrived { source: *light, draw: at.arrival.draw, lanes, parted });
        // Its light is of other wavelengths than that of the photon, whose lanes may have parted.
        let draw = &world.method.basis.draw(self.sampler.four_plain(path.key.child(DYE + dye), LENS)[0]);
        let mut shares = Vec::new();
        at.material.shares_of_dyes(&Arrival { draw, ..*viewed }, Lanes::ONE, &mut shares);
        let at = &at.of_dye(&dyes.white, draw);
        let polarization = path.polarization.exciting();
        let mut unpolarized = Lanes::ONE;
        let start = || polarization.shown(at, self.seen.direction, &mut unpolarized);
        let (arriving, on_its_way) = self.arriving(draw, start, || draw.start())?;
        let polarized = polarization.seen(at, viewed, &on_its_way, world, &self.back());
        let arriving =
            polarized.factor.map_or(arriving, |factor| arriving * factor) * shares[number] * brightness as f32;
        let arrived = Arrived { source: dyes.source(dye), draw, lanes: &arriving, parted: false };
        let first = world.layers.tell_lobes_apart().then_some(FirstLobe::Reflected { diffuse: [1.0; 3] });
        Some(self.splat(&arrived, &polarized, parted, first))
    }

    /// Of light that arrives at the camera.
    fn splat(
        &self,
        arrived: &Arrived<N>,
        polarized: &SeenPhoton<N>,
        dispersed: bool,
        first: Option<FirstLobe>,
    ) -> Splat {
        let (world, factor) = (self.walker.world, self.factor());
        let rgb = arrived.rgb(&world.responses).map(|x| x * factor);
        let spectrum = world.layers.spectrum.as_ref();
        let of_bands = |spectrum: &Spectrum| spectrum.of(arrived, polarized.stokes.as_ref(), factor);
        let bands = spectrum.map(|spectrum| of_bands(spectrum).into_iter().map(|x| x as f32).collect());
        let color = |part: Lanes<N>| arrived.times(part, &world.responses).map(|x| x * factor);
        let stokes = polarized.stokes.map(|stokes| Arc::new(stokes.map(color)));
        let Landing { light, early, .. } = *self.landing;
        let changed = || arrived.times(Lanes::ONE + polarized.change, &world.responses).map(|x| x * factor);
        let change = if polarized.change.is_zero() { 0.0 } else { world.share_of_change(rgb, changed()) as f32 };
        let caught = self.sight == Sight::ShadowCatcher;
        Splat { pixel: 0, change, rgb, stokes, bands, weight: 1.0, light, dispersed, early, caught, first }
    }

    /// Adds a splat to all pixels that it reaches.
    fn spread(&self, splat: Option<Splat>, splats: &mut Vec<Splat>) {
        let film = self.walker.world.scene.film;
        if let Some(splat) = splat {
            self.places.iter().for_each(|&place| spread_over_pixels(film, place, &splat, splats));
        }
    }
}

/// Spreads a splat over the pixels around a place of the film, as the filter weighs them.
fn spread_over_pixels(film: FilmSettings, place: DVec2, splat: &Splat, splats: &mut Vec<Splat>) {
    let (window, reach) = (film.window(), film.filter.reach());
    let [first, end] = window.ends();
    let first = |x: f64, axis: usize| (x - reach - 0.5).floor().max(first[axis] as f64) as i32;
    let last = |x: f64, axis: usize| (x + reach).floor().min((end[axis] - 1) as f64) as i32;
    for y in first(place.y, 1)..=last(place.y, 1) {
        for x in first(place.x, 0)..=last(place.x, 0) {
            let middle = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            // Shadow catchers show no light, but the share of it that is missing.
            let filter = |offset| match splat.caught {
                true => film.filter.positive_value(offset),
                false => film.filter.value(offset),
            };
            let weight = filter(place - middle);
            if weight != 0.0 {
                let pixel = (y - window.top) as u32 * window.width + (x - window.left) as u32;
                let rgb = splat.rgb.map(|channel| channel * weight);
                splats.push(Splat { pixel, rgb, weight, ..splat.clone() });
            }
        }
    }
}

/// The branch of what passes holes, beyond those that a material may have.
const BEYOND: usize = 64;
/// Use of the random numbers where a photon leaves a surface, and where it passes one or not.
const SCATTER: u32 = 4;
const STRAIGHT: u32 = 9;
