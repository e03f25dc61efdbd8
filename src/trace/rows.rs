//! Polarization traced: rows of Stokes weights, followed backward.
//!
//! A sensor that takes the intensity of light takes the scalar product of a row of four weights with the light's Stokes
//! vector. On its way back the row is multiplied by the Mueller matrix of each surface: of unpolarized light its first
//! weight is what counts, which is the path's throughput. The others are kept as shares of it, with the reference
//! direction of their frame, the last surface's s. (Rows and columns: Jarabo & Arellano 2018, *Bidirectional Rendering
//! of Vector Light Transport*. Mueller matrices are reciprocal, M of the way back = Q M^T Q with Q = diag(1, 1, -1, 1):
//! Sekera 1966, *Scattering Matrices and Reciprocity Relationships*. So photons are followed by the same code.)

use super::World;
use super::arrived::Arrived;
use super::interaction::Interaction;
use super::method::Polarizing;
use super::polarization::{MetLight, Polarization, SeenPhoton};
use super::shading;
use crate::light::Light;
use crate::material::{Arrival, Block, Branch, Incoming, Material, Mueller, Scatter, Straight};
use crate::math::{DVec3, Frame, Ray};
use crate::spectrum::{Lanes, Table};

/// What the sensor takes of each Stokes component, lane by lane: the row of S0 of the image alone, or all `K` = 4.
/// Paths are copied, and one row is all that most images need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<const N: usize, const K: usize> {
    /// The x of the frame whose z is the direction of the light, back along the ray: a unit vector.
    x: DVec3,
    /// Each over the throughput: the first begins with 1.
    rows: [[Lanes<N>; 4]; K],
    /// Whether the throughput is that of a path whose light is taken for unpolarized at every surface, which is
    /// compared.
    compares: bool,
}

/// How light that a photon brings is polarized.
#[derive(Clone, Debug)]
pub(super) struct Column<const N: usize> {
    x: DVec3,
    /// S0 to S3 over what light would be that is taken for unpolarized.
    stokes: [Lanes<N>; 4],
}

/// Cosine and sine of twice the angle from one reference direction to another, about the direction z of the light.
#[derive(Clone, Copy)]
struct Turn(f32, f32);

impl Turn {
    const NONE: Self = Self(1.0, 0.0);

    /// From the unit vector `x`; none to a direction that has no part across z.
    fn new(z: DVec3, x: DVec3, to: DVec3) -> Option<Self> {
        let (c, t) = (x.dot(to), z.cross(x).dot(to));
        let length = c * c + t * t;
        let inverse = 1.0 / length;
        (length > 0.0).then_some(Self(((c * c - t * t) * inverse) as f32, (2.0 * c * t * inverse) as f32))
    }

    /// Of the linear components, 1 and 2.
    #[inline(always)]
    fn of(self, one: f32, two: f32) -> [f32; 2] {
        let Self(c, s) = self;
        [one * c + two * s, two * c - one * s]
    }
}

/// A unit vector across z, near a direction.
fn across(z: DVec3, near: DVec3) -> DVec3 {
    (near - z * z.dot(near)).try_normalize().unwrap_or_else(|| Frame::about(z).to_world(DVec3::X))
}

/// Makes rows of one lane, of light of which `value` would leave if it were unpolarized, shares of what leaves: of
/// `value` itself where that is compared. Answers the factor on `value`.
#[inline(always)]
fn shares_of<const K: usize>(rows: &mut [[f32; 4]; K], value: f32, compares: bool) -> f32 {
    let inverse = |x: f32| if x > 0.0 { 1.0 / x } else { 0.0 };
    let first = rows[0][0];
    let scale = inverse(if compares { value } else { first });
    rows.iter_mut().flatten().for_each(|part| *part *= scale);
    if compares {
        return 1.0;
    }
    // Rounding may leave a degree above 1.
    let [_, one, two, three] = rows[0];
    let squared = one * one + two * two + three * three;
    let within = 1.0 / if squared > 1.0 { squared } else { 1.0 }.sqrt();
    rows[0][1..].iter_mut().for_each(|part| *part *= within);
    first.max(0.0) * inverse(value)
}

/// One way by which light leaves a surface.
struct Passing<'a, const N: usize> {
    mueller: &'a Mueller<N>,
    /// What leaves of unpolarized light.
    value: Lanes<N>,
    /// The lanes that do, each 1.
    present: Lanes<N>,
    /// The direction of the light on both sides of the surface, to the viewer and before it arrives.
    z: [DVec3; 2],
}

impl<const N: usize, const K: usize> Rows<N, K> {
    /// Where light meets no surface before it reaches the sensor, which has image right at `x`.
    fn starting(x: DVec3, compares: bool) -> Self {
        let one = |row: usize, column: usize| if row == column { Lanes::ONE } else { Lanes::ZERO };
        let rows = std::array::from_fn(|row| std::array::from_fn(|column| one(row, column)));
        Self { x, rows, compares }
    }

    /// Goes on beyond a surface; answers the factor by which polarization changes what leaves it.
    fn pass(&mut self, passing: &Passing<N>) -> Lanes<N> {
        let Passing { mueller, value, present, z: [z, onward] } = *passing;
        let Mueller { axis, block, base } = mueller;
        let base = base.as_ref().map(|base| {
            let inward = across(onward, onward.cross(base.normal));
            (base, Turn::new(z, self.x, z.cross(base.normal)).unwrap_or(Turn::NONE), inward)
        });
        let met = Turn::new(z, self.x, *axis);
        self.x = match (&base, met) {
            (Some((.., inward)), None) => *inward,
            (_, None) => across(onward, self.x),
            (_, Some(_)) => across(onward, *axis),
        };
        let met = met.unwrap_or(Turn::NONE);
        let base =
            base.map(|(base, turn, inward)| (base, turn, Turn::new(onward, inward, self.x).unwrap_or(Turn::NONE)));
        self.each_lane(present, value, |i, [q0, q1, q2, q3]| {
            let [r1, r2] = met.of(q1, q2);
            let mut row = [
                value[i] * q0 + block.d[i] * r1,
                block.d[i] * q0 + block.a[i] * r1,
                block.c[i] * r2 + block.q[i] * q3,
                block.c[i] * q3 - block.q[i] * r2,
            ];
            if let Some((base, turn, back)) = &base {
                let [u1, _] = turn.of(q1, q2);
                let [v1, v2] = back.of(base.arriving[i] * q0 + base.both[i] * u1, 0.0);
                row[0] += base.leaving[i] * u1;
                row[1] += v1;
                row[2] += v2;
            }
            row
        })
    }

    /// Changes the rows of the lanes that are present, where `value` is what becomes of unpolarized light, and makes
    /// them shares of what the throughput becomes; answers the factor on `value`. A lane that has parted from the
    /// others is alone, and to ask it alone takes a fraction of the time.
    #[inline(always)]
    fn each_lane(
        &mut self,
        present: Lanes<N>,
        value: Lanes<N>,
        changed: impl Fn(usize, [f32; 4]) -> [f32; 4],
    ) -> Lanes<N> {
        let mut factor = Lanes::ONE;
        if present == Lanes::ONE {
            for i in 0..N {
                factor.0[i] = self.lane(i, value[i], &changed);
            }
        } else {
            for i in present.present() {
                factor.0[i] = self.lane(i, value[i], &changed);
            }
        }
        factor
    }

    /// The same of one lane.
    #[inline(always)]
    fn lane(&mut self, i: usize, value: f32, changed: &impl Fn(usize, [f32; 4]) -> [f32; 4]) -> f32 {
        let mut rows = [[0.0; 4]; K];
        for (row, [zero, one, two, three]) in rows.iter_mut().zip(&self.rows) {
            *row = changed(i, [zero[i], one[i], two[i], three[i]]);
        }
        let factor = shares_of(&mut rows, value, self.compares);
        for ([zero, one, two, three], row) in self.rows.iter_mut().zip(rows) {
            [zero.0[i], one.0[i], two.0[i], three.0[i]] = row;
        }
        factor
    }

    /// Goes on beyond a surface that light leaves by a way; answers the factor on what leaves.
    fn pass_by(&mut self, at: &Interaction<N>, incoming: Incoming, value: Lanes<N>) -> Lanes<N> {
        // Lanes that do not come this way are not asked for.
        let present = Lanes::from_fn(|i| if value[i] == 0.0 { 0.0 } else { at.arrival.present[i] });
        let mueller = at.material.mueller(&Arrival { present, ..at.arrival }, incoming);
        let z = [at.arrival.wo, -incoming.wi];
        self.pass(&Passing { mueller: &mueller, value, present, z })
    }

    /// The mirror image in a plane: light that was folded there by a shading normal.
    fn fold(&mut self, flat: DVec3) {
        self.x = shading::folded(self.x, flat);
        for row in &mut self.rows {
            (row[2], row[3]) = (row[2] * -1.0, row[3] * -1.0);
        }
    }

    /// The direction by which a material was asked, where shading normals have folded it to `incoming`.
    fn unfolded(at: &Interaction<N>, incoming: Incoming) -> Option<Incoming> {
        let is_folded = at.flat != at.arrival.normal && (incoming.wi.dot(at.arrival.normal) < 0.0) != incoming.crosses;
        is_folded.then(|| Incoming { wi: shading::folded(incoming.wi, at.flat), ..incoming })
    }

    /// The same as `pass_by`, along a direction that shading normals may have folded.
    fn pass_folded(&mut self, at: &Interaction<N>, incoming: Incoming, value: Option<Lanes<N>>) -> Lanes<N> {
        // Such a surface leaves no polarization.
        if let Material::Diffuse(_) = at.material {
            self.rows.iter_mut().flat_map(|row| &mut row[1..]).for_each(|part| *part = Lanes::ZERO);
            self.x = across(incoming.wi, self.x);
            return Lanes::ONE;
        }
        let drawn = Self::unfolded(at, incoming);
        let asked = drawn.unwrap_or(incoming);
        let evaluated = || at.material.evaluate(&at.arrival, asked.wi).map_or(Lanes::ZERO, |(light, _)| light);
        let factor = self.pass_by(at, asked, value.unwrap_or_else(evaluated));
        if drawn.is_some() {
            self.fold(at.flat);
        }
        factor
    }

    /// Takes light of some polarization, whose direction is z; answers the factor on its intensity.
    fn receive(&mut self, z: DVec3, light: &Column<N>) -> Lanes<N> {
        let turn = Turn::new(z, self.x, light.x).unwrap_or(Turn::NONE);
        let [s0, s1, s2, s3] = light.stokes;
        self.each_lane(Lanes::ONE, Lanes::ONE, |i, [q0, q1, q2, q3]| {
            let [r1, r2] = turn.of(q1, q2);
            [q0 * s0[i] + r1 * s1[i] + r2 * s2[i] + q3 * s3[i], q1, q2, q3]
        })
    }

    /// The light that a photon brings which has followed the first row: Q times it.
    fn column(&self) -> Column<N> {
        let [zero, one, two, three] = self.rows[0];
        Column { x: self.x, stokes: [zero, one, two * -1.0, three] }
    }

    /// By how much polarization changes light that is compared.
    fn compared(&self, light: &MetLight<N, Self>) -> f64 {
        if !self.compares {
            return 0.0;
        }
        let MetLight { world, arrived, rgb, .. } = *light;
        let lanes = &(*arrived.lanes * self.rows[0][0]);
        let exact = Arrived { lanes, ..*arrived };
        let exact = match light.excitation {
            None => exact.rgb(&world.responses),
            Some(dye) => dye.seen(world, &exact, |seen| seen.times(dye.polarization.rows[0][0], &world.responses)),
        };
        world.amount(exact) - world.amount(rgb)
    }
}

impl<const N: usize, const K: usize> Polarization<N> for Rows<N, K> {
    /// None on surfaces that leave no polarization.
    type Landed = Option<Box<Column<N>>>;

    fn of_camera(world: &World, ray: &Ray) -> Self {
        let camera = &world.scene.camera;
        let x = camera.image_right(ray.direction);
        let mut rows = Self::starting(x, world.method.polarization == Polarizing::Compared);
        if let Some(filter) = camera.filter() {
            let (z, value) = (-ray.direction, Lanes([filter.transmittance() as f32; N]));
            let (sin, cos) = libm::sincos(filter.angle);
            let axis = x * cos + z.cross(x) * sin;
            let mueller = Mueller::of_lanes(axis, Lanes::ONE, |_| Block::of_polarizer(filter.extinction));
            rows.pass(&Passing { mueller: &mueller, value, present: Lanes::ONE, z: [z; 2] });
        }
        rows
    }

    fn of_light(world: &World, ray: &Ray) -> Self {
        let x = Frame::about(ray.direction).to_world(DVec3::X);
        Self::starting(x, world.method.polarization == Polarizing::Compared)
    }

    fn after_straight(mut self, material: &Material<Table>, arrival: &Arrival<N>, straight: &mut Straight<N>) -> Self {
        let (mueller, value) = (material.mueller_of_straight(arrival), straight.share());
        let present = arrival.present;
        let factor = self.pass(&Passing { mueller: &mueller, value, present, z: [arrival.wo; 2] });
        let share = value * factor;
        straight.panes = Lanes::from_fn(|i| (share[i] - straight.holes[i]).max(0.0));
        self
    }

    fn split(&self, at: &Interaction<N>, branches: &mut [Branch<N>], after: &mut Vec<Self>) {
        after.clear();
        for branch in branches {
            let number = after.len();
            after.extend_from_slice(std::slice::from_ref(self));
            let value = match branch.pdf {
                None => Some(branch.share),
                Some(pdf) if at.flat == at.arrival.normal => Some(branch.share * pdf as f32),
                Some(_) => None,
            };
            branch.share = branch.share * after[number].pass_folded(at, branch.incoming(), value);
        }
    }

    fn along(&self, _: &Interaction<N>, _: &Branch<N>, known: Option<&Self>) -> Self {
        *known.expect("`split` tells of all branches")
    }

    fn toward(&self, at: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self {
        let crosses = wi.dot(at.flat) < 0.0;
        let value = if at.flat == at.arrival.normal { Some(*bsdf_cos) } else { None };
        let mut after = *self;
        *bsdf_cos = *bsdf_cos * after.pass_folded(at, Incoming { wi, crosses, single: false }, value);
        after
    }

    fn moved(&self, _: &Interaction<N>, _: DVec3, on_its_way: &Self, light: &MetLight<N, Self>) -> f64 {
        on_its_way.compared(light)
    }

    fn moved_of_met(&self, light: &MetLight<N, Self>) -> f64 {
        self.compared(light)
    }

    fn exciting(&self) -> Self {
        Self::starting(self.x, self.compares)
    }

    fn lit_by(mut self, light: &Light<Table>, wi: DVec3, shone: &mut Lanes<N>) -> Self {
        let Some((axis, degree)) = light.polarization().and_then(|sky| sky.toward(wi)) else { return self };
        let stokes = [1.0, degree as f32, 0.0, 0.0].map(|part| Lanes([part; N]));
        *shone = *shone * self.receive(-wi, &Column { x: axis, stokes });
        self
    }

    fn shown(&self, at: &Interaction<N>, direction: DVec3, bsdf_cos: &mut Lanes<N>) -> Self {
        let mut after = *self;
        let incoming = Incoming { wi: direction, crosses: direction.dot(at.flat) < 0.0, single: false };
        *bsdf_cos = *bsdf_cos * after.pass_folded(at, incoming, None);
        after
    }

    fn seen(&self, _: &Interaction<N>, _: &Arrival<N>, on_its_way: &Self, world: &World, ray: &Ray) -> SeenPhoton<N> {
        let mut after = Self::of_camera(world, ray);
        let factor = after.receive(-ray.direction, &on_its_way.column());
        let change = if self.compares { after.rows[0][0] + Lanes([-1.0; N]) } else { Lanes::ZERO };
        SeenPhoton { change, factor: Some(factor), stokes: after.stokes() }
    }

    fn landed(&self, at: &Interaction<N>) -> Self::Landed {
        let is_of_no_use = matches!(at.material, Material::Diffuse(_)) && !self.compares;
        (!is_of_no_use).then(|| Box::new(self.column()))
    }

    fn join(&self, at: &Interaction<N>, wi: DVec3, photon: &Self::Landed, bsdf_cos: &mut Lanes<N>) -> Self {
        let mut after = self.toward(at, wi, bsdf_cos);
        if let Some(light) = photon {
            *bsdf_cos = *bsdf_cos * after.receive(-wi, light);
        }
        after
    }

    fn change_of_joined(&self, _: &Interaction<N>, _: DVec3, _: &Self::Landed, joined: &Self, lanes: Lanes<N>) -> f64 {
        let all = f64::from(lanes.sum());
        if self.compares && all > 0.0 { f64::from((lanes * joined.rows[0][0]).sum()) / all - 1.0 } else { 0.0 }
    }

    fn read_landed(photon: &Self::Landed, read: impl Fn(Lanes<N>) -> Lanes<N>) -> Self::Landed {
        photon.as_ref().map(|column| Box::new(Column { x: column.x, stokes: column.stokes.map(read) }))
    }

    fn stokes(&self) -> Option<[Lanes<N>; 3]> {
        (K == 4).then(|| [1, 2, 3].map(|row| self.rows[row][0]))
    }
}
