//! Traced polarization: rows of Stokes weights, followed backward.
//!
//! A sensor that measures intensity takes the scalar product of a row of four weights with the light's Stokes vector.
//! On the way back, the row is multiplied by the Mueller matrix of each surface. For unpolarized light only the first
//! weight counts, which is the path's throughput. The other weights are stored relative to it, with the reference
//! direction of their frame, the last surface's s. (Rows and columns: Jarabo & Arellano 2018, *Bidirectional Rendering
//! of Vector Light Transport*. Mueller matrices are reciprocal, M of the way back = Q M^T Q with Q = diag(1, 1, -1, 1):
//! Sekera 1966, *Scattering Matrices and Reciprocity Relationships*. Photons are thus followed by the same code.)

use std::array::from_fn;

use super::interaction::Interaction;
use super::polarization::{FoundLight, Polarization, SeenPhoton};
use super::reusing_stack::Slots;
use super::rotation::{Rotation, perpendicular};
use super::row_change::{Change, Weights};
use super::row_transfer::{Exitant, FoldedLight, RowTransfer};
use super::shading;
use crate::light::Light;
use crate::material::{Block, Branch, Incoming, Material, Mueller, Scatter, ScatterContext, Straight};
use crate::math::{DVec3, Frame, Ray};
use crate::spectrum::{Lanes, Table};
use crate::trace::World;
use crate::trace::method::Polarizing;
use crate::trace::received_light::ReceivedLight;

/// The sensor's weight for each Stokes component, lane by lane: only the row of the image's S0, or all `K` = 4 rows.
/// Paths are copied, and most images need only one row.
#[derive(Clone, Copy, Debug)]
pub struct Rows<const N: usize, const K: usize> {
    /// The x axis of the frame whose z is the light's direction, back along the ray. It may have any length, and is
    /// perpendicular to z up to rounding.
    x: DVec3,
    /// Weights relative to the throughput: the first starts at 1. Those of a lane are adjacent, as one is often alone.
    weights: [Weights<K>; N],
    /// Whether the throughput is that of light taken to be unpolarized at every surface, for comparison.
    compares: bool,
}

/// The polarization of light that a photon carries.
#[derive(Clone, Debug)]
pub struct Column<const N: usize> {
    x: DVec3,
    /// S0 to S3, relative to the light if it were taken to be unpolarized.
    stokes: [Lanes<N>; 4],
}

/// Returns one over a number, or 0 if the number is 0 or so small that it has lost its significant digits.
#[inline(always)]
fn inverse(x: f32) -> f32 {
    if x >= f32::MIN_POSITIVE { 1.0 / x } else { 0.0 }
}

impl<const N: usize, const K: usize> Rows<N, K> {
    /// Returns the rows of light that hits no surface before it reaches the sensor, which has image right at `x`.
    fn initial(x: DVec3, compares: bool) -> Self {
        let identity = from_fn(|part| from_fn(|row| if row == part { 1.0 } else { 0.0 }));
        Self { x, weights: [identity; N], compares }
    }

    /// Sets `change` to how rows change beyond a surface, and `share` to what leaves of the path's light.
    #[inline(always)]
    fn find_change(&self, mueller: &Mueller<N>, exitant: &Exitant<N>, change: &mut Change<N>, share: &mut Lanes<N>) {
        let Exitant { value, lanes, z: [z, onward] } = exitant;
        let (z, onward, to_block) = (*z, *onward, Rotation::new(*z, self.x, mueller.axis));
        let inward = mueller.base.as_ref().map(|base| perpendicular(onward, onward.cross(base.normal)));
        change.x = match (inward, to_block) {
            (Some(inward), None) => inward,
            (None, None) => perpendicular(onward, self.x),
            (_, Some(_)) => mueller.axis,
        };
        change.to_block = to_block.unwrap_or(Rotation::NONE);
        if let (Some(base), Some(inward)) = (&mueller.base, inward) {
            change.base = [Rotation::new(z, self.x, z.cross(base.normal)), Rotation::new(onward, inward, change.x)]
                .map(|turn| turn.unwrap_or(Rotation::NONE));
        }
        change.only_lane = lanes.single_lane();
        if self.compares {
            change.value = *value;
            change.scale = Lanes::from_fn(|i| inverse(value[i]));
        } else if let Some(i) = change.only_lane {
            change.value.0[i] = value[i];
            let [[first], ..] = change.apply(mueller, i, self.first_row(i));
            change.scale.0[i] = inverse(first);
            share.0[i] *= first.max(0.0) * inverse(value[i]);
        } else {
            change.value = *value;
            let firsts: Lanes<N> = match mueller.base {
                None => Lanes::from_fn(|i| change.apply_block(&mueller.block, i, self.first_row(i))[0][0]),
                Some(_) => Lanes::from_fn(|i| change.apply(mueller, i, self.first_row(i))[0][0]),
            };
            change.scale = Lanes::from_fn(|i| inverse(firsts[i]));
            *share = Lanes::from_fn(|i| share[i] * (if firsts[i] > 0.0 { firsts[i] } else { 0.0 } * inverse(value[i])));
        }
    }

    /// Returns one lane of the first row.
    #[inline(always)]
    fn first_row(&self, i: usize) -> Weights<1> {
        self.weights[i].map(|part| [part[0]])
    }

    /// Returns the first weight of the first row, from which the image is made.
    fn first_weights(&self) -> Lanes<N> {
        Lanes::from_fn(|i| self.weights[i][0][0])
    }

    /// Sets one lane.
    #[inline(always)]
    fn set_lane(&mut self, i: usize, weights: Weights<K>, scale: f32) {
        self.weights[i] = weights.map(|part| part.map(|weight| weight * scale));
    }

    /// Becomes the rows beyond a surface, given the rows `before`. Lanes that are not on the ray stay as they are.
    fn transform(&mut self, before: &Self, mueller: &Mueller<N>, change: &Change<N>) {
        (self.x, self.compares) = (change.x, before.compares);
        match (change.only_lane, &mueller.base) {
            (Some(i), _) => self.set_lane(i, change.apply(mueller, i, before.weights[i]), change.scale[i]),
            (None, None) => {
                for i in 0..N {
                    self.set_lane(i, change.apply_block(&mueller.block, i, before.weights[i]), change.scale[i]);
                }
            }
            (None, Some(_)) => {
                for i in 0..N {
                    self.set_lane(i, change.apply(mueller, i, before.weights[i]), change.scale[i]);
                }
            }
        }
        match change.only_lane {
            _ if self.compares => {}
            Some(i) if self.degree_squared(i) <= 1.0 => {}
            Some(i) => self.limit_degree(i),
            None => (0..N).for_each(|i| self.limit_degree(i)),
        }
    }

    #[inline(always)]
    fn degree_squared(&self, i: usize) -> f32 {
        let [_, [one], [two], [three]] = self.first_row(i);
        one * one + two * two + three * three
    }

    /// Limits the degree of polarization to 1, because of rounding.
    #[inline(always)]
    fn limit_degree(&mut self, i: usize) {
        let squared = self.degree_squared(i);
        let scale = 1.0 / if squared > 1.0 { squared } else { 1.0 }.sqrt();
        self.weights[i][1..].iter_mut().for_each(|part| part[0] *= scale);
    }

    /// Passes a surface, and sets `share` to what leaves of the path's light.
    #[inline(never)]
    fn pass_surface(&mut self, mueller: &Mueller<N>, exitant: &Exitant<N>, share: &mut Lanes<N>) {
        let (before, mut change) = (*self, Change::NONE);
        self.find_change(mueller, exitant, &mut change, share);
        self.transform(&before, mueller, &change);
    }

    /// Sets `mueller` to what a surface does to light that leaves it in one way, and returns that way.
    #[inline(always)]
    fn set_mueller(
        interaction: &Interaction<N>,
        incoming: Incoming,
        value: Lanes<N>,
        mueller: &mut Mueller<N>,
    ) -> Exitant<N> {
        interaction.material.mueller(&interaction.context, incoming, mueller);
        Exitant { value, lanes: incoming.lanes, z: [interaction.context.wo, -incoming.wi] }
    }

    /// Becomes the rows beyond a surface that leaves no polarization, with `x` as their frame.
    fn depolarize(&mut self, before: &Self, x: DVec3) {
        (self.x, self.compares) = (x, before.compares);
        for (weights, [firsts, ..]) in self.weights.iter_mut().zip(before.weights) {
            *weights = [firsts, [0.0; K], [0.0; K], [0.0; K]];
        }
    }

    /// Mirrors the rows in a plane, for light that a shading normal folded there.
    fn fold(&mut self, flat: DVec3) {
        self.x = shading::folded_direction(self.x, flat);
        for weights in &mut self.weights {
            weights[2..].iter_mut().flatten().for_each(|weight| *weight *= -1.0);
        }
    }

    /// Merges rows of light that arrives in the same direction, which is z, in proportion to the light of both.
    fn merge(&mut self, other: &Self, z: DVec3, [own, others]: &[Lanes<N>; 2]) {
        let turn = Rotation::new(z, other.x, self.x).unwrap_or(Rotation::NONE);
        for (i, weights) in self.weights.iter_mut().enumerate() {
            let [p0, p1, p2, p3] = other.weights[i];
            let [r1, r2] = turn.apply(p1, p2);
            let share = others[i] * inverse(own[i] + others[i]);
            for (part, other) in weights.iter_mut().zip([p0, r1, r2, p3]) {
                *part = from_fn(|k| part[k] + share * (other[k] - part[k]));
            }
        }
    }

    /// Returns how rows change by light that is folded into the direction of other light. Of the other light,
    /// `straight` leaves of unpolarized light and `left` of the path's. Sets `share` to what leaves of the path's light
    /// of both.
    #[inline(never)]
    fn folded_light(
        &self,
        interaction: &Interaction<N>,
        folded: Incoming,
        [straight, left]: [Lanes<N>; 2],
        share: &mut Lanes<N>,
    ) -> FoldedLight<N> {
        let (value, mut mueller, mut change) = (interaction.bsdf_value(folded.wi), Mueller::NONE, Change::NONE);
        let (exitant, mut light) = (Self::set_mueller(interaction, folded, value, &mut mueller), value);
        self.find_change(&mueller, &exitant, &mut change, &mut light);
        if !self.compares {
            *share = Lanes::from_fn(|i| share[i] * (left[i] + light[i]) * inverse(straight[i] + value[i]));
        }
        FoldedLight { mueller, change, lights: [left, light] }
    }

    /// Merges light folded into the direction of the rows' light, which is z. `before` are the rows at the surface.
    fn merge_folded(&mut self, before: &Self, folded_light: &FoldedLight<N>, z: DVec3, flat: DVec3) {
        let mut other = *before;
        other.transform(before, &folded_light.mueller, &folded_light.change);
        other.fold(flat);
        self.merge(&other, z, &folded_light.lights);
    }

    /// Returns the rows after a surface, along a direction that shading normals may have folded. Converts `bsdf_cos` to
    /// that of the path.
    fn after_surface(
        &self,
        interaction: &Interaction<N>,
        wi: DVec3,
        value: Option<Lanes<N>>,
        bsdf_cos: &mut Lanes<N>,
    ) -> Self {
        let mut after = *self;
        if let Material::Diffuse(_) = interaction.material {
            after.depolarize(self, perpendicular(wi, self.x));
            return after;
        }
        let lanes = interaction.context.present.nonzero();
        let incoming = Incoming { wi, crosses: wi.dot(interaction.flat) < 0.0, single: false, lanes };
        let drawn = interaction.unfolded(incoming);
        let (query, mut mueller) = (drawn.unwrap_or(incoming), Mueller::NONE);
        let value = value.unwrap_or_else(|| interaction.bsdf_value(query.wi));
        let exitant = Self::set_mueller(interaction, query, value, &mut mueller);
        if let Some(folded) = interaction.folded_to(incoming) {
            let mut leaving = value;
            after.pass_surface(&mueller, &exitant, &mut leaving);
            let folded_light = self.folded_light(interaction, folded, [value, leaving], bsdf_cos);
            after.merge_folded(self, &folded_light, -wi, interaction.flat);
            return after;
        }
        after.pass_surface(&mueller, &exitant, bsdf_cos);
        if drawn.is_some() {
            after.fold(interaction.flat);
        }
        after
    }

    /// Returns the rows of light that is followed forward, beyond a surface that it leaves in one way to the viewer. If
    /// `is_folded`, it is folded before it arrives. Converts `share` from unpolarized light to the path's light.
    fn sent_forward(
        &self,
        interaction: &Interaction<N>,
        incoming: Incoming,
        is_folded: bool,
        share: &mut Lanes<N>,
    ) -> Self {
        let (mut after, mut mueller) = (*self, Mueller::NONE);
        if is_folded {
            after.fold(interaction.flat);
        }
        let exitant = Self::set_mueller(interaction, incoming, *share, &mut mueller).reversed();
        mueller.turn_back();
        after.pass_surface(&mueller, &exitant, share);
        after
    }

    /// Receives polarized light whose direction is z, and returns the factor on its intensity.
    fn receive(&mut self, z: DVec3, light: &Column<N>) -> Lanes<N> {
        let turn = Rotation::new(z, self.x, light.x).unwrap_or(Rotation::NONE);
        for (i, weights) in self.weights.iter_mut().enumerate() {
            let ([s0, s1, s2, s3], [q0, q1, q2, q3]) = (light.stokes.map(|part| part[i]), *weights);
            let [r1, r2] = turn.apply(q1, q2);
            weights[0] = from_fn(|k| q0[k] * s0 + r1[k] * s1 + r2[k] * s2 + q3[k] * s3);
        }
        if self.compares {
            return Lanes::ONE;
        }
        let taken = self.first_weights();
        (0..N).for_each(|i| self.set_lane(i, self.weights[i], inverse(taken[i])));
        Lanes::from_fn(|i| if taken[i] > 0.0 { taken[i] } else { 0.0 })
    }

    /// Returns the light of a photon that has followed the first row: Q times the row.
    fn column(&self) -> Column<N> {
        let [zero, one, two, three] = from_fn(|part| Lanes::from_fn(|i| self.weights[i][part][0]));
        Column { x: self.x, stokes: [zero, one, two * -1.0, three] }
    }

    /// Returns how much polarization changes light that is compared.
    fn measured_change(&self, light: &FoundLight<N, Self>) -> f64 {
        if !self.compares {
            return 0.0;
        }
        let FoundLight { world, received, rgb, .. } = *light;
        let lanes = &(*received.lanes * self.first_weights());
        let exact = ReceivedLight { lanes, ..*received };
        let exact = match light.excitation {
            None => exact.rgb(&world.responses),
            Some(dye) => {
                dye.with_received(world, &exact, |seen| seen.times(dye.polarization.first_weights(), &world.responses))
            }
        };
        world.amount(exact) - world.amount(rgb)
    }
}

impl<const N: usize, const K: usize> Polarization<N> for Rows<N, K> {
    /// `None` on surfaces that leave no polarization.
    type Stored = Option<Box<Column<N>>>;
    type RowTransfer = RowTransfer<N>;

    fn at_camera(world: &World, ray: &Ray) -> Self {
        let camera = &world.scene.camera;
        let x = camera.image_right(ray.direction);
        let mut rows = Self::initial(x, world.method.polarization == Polarizing::Compared);
        if let Some(filter) = camera.filter() {
            let (z, lanes) = (-ray.direction, Lanes::<N>::ONE.nonzero());
            let mut value = Lanes([filter.transmittance() as f32; N]);
            let (sin, cos) = libm::sincos(filter.angle);
            let axis = x * cos + z.cross(x) * sin;
            let mut mueller = Mueller::NONE;
            mueller.set_lanes(axis, lanes, |_| Block::of_polarizer(filter.extinction));
            rows.pass_surface(&mueller, &Exitant { value, lanes, z: [z; 2] }, &mut value);
        }
        rows
    }

    fn at_light(world: &World, ray: &Ray) -> Self {
        let x = Frame::about(ray.direction).to_world(DVec3::X);
        Self::initial(x, world.method.polarization == Polarizing::Compared)
    }

    fn pass(mut self, material: &Material<Table>, context: &ScatterContext<N>, straight: &mut Straight<N>) -> Self {
        let (mut mueller, mut share) = (Mueller::NONE, straight.share());
        material.mueller_of_straight(context, &mut mueller);
        let exitant = Exitant { value: share, lanes: context.present.nonzero(), z: [context.wo; 2] };
        self.pass_surface(&mueller, &exitant, &mut share);
        straight.panes = Lanes::from_fn(|i| (share[i] - straight.holes[i]).max(0.0));
        self
    }

    fn split(&self, interaction: &Interaction<N>, branches: &mut [Branch<N>], transfers: &mut Slots<RowTransfer<N>>) {
        transfers.clear();
        for branch in branches {
            let transfer = transfers.add(RowTransfer::new);
            transfer.is_polarized = !matches!(interaction.material, Material::Diffuse(_));
            if !transfer.is_polarized {
                transfer.change.x = perpendicular(branch.wi, self.x);
                continue;
            }
            let incoming = branch.incoming(&interaction.context.present);
            let drawn = interaction.unfolded(incoming);
            let query = drawn.unwrap_or(incoming);
            let value = match branch.pdf {
                None => branch.share,
                // Where lanes part, a branch's share is that of its own lanes, and its density that of all lanes.
                Some(pdf) if !(interaction.is_smoothed() || (interaction.is_parting && branch.crosses)) => {
                    branch.share * pdf as f32
                }
                Some(_) => interaction.bsdf_value(query.wi),
            };
            let exitant = Self::set_mueller(interaction, query, value, &mut transfer.mueller);
            transfer.fold_plane = drawn.map(|_| interaction.flat);
            transfer.folded_light = None;
            if let Some(folded) = interaction.folded_to(incoming) {
                let mut leaving = value;
                self.find_change(&transfer.mueller, &exitant, &mut transfer.change, &mut leaving);
                let folded_light = self.folded_light(interaction, folded, [value, leaving], &mut branch.share);
                transfer.folded_light = Some(Box::new(folded_light));
                continue;
            }
            self.find_change(&transfer.mueller, &exitant, &mut transfer.change, &mut branch.share);
        }
    }

    fn follow(
        &mut self,
        before: &Self,
        interaction: &Interaction<N>,
        branch: &Branch<N>,
        transfer: Option<&RowTransfer<N>>,
    ) {
        let Some(RowTransfer { is_polarized, mueller, change, fold_plane, folded_light }) = transfer else {
            // The branch's share is already that of the path's light.
            let mut share = branch.share;
            let reversed = interaction.viewed_from(branch.wi);
            *self = before.after_forward_scattering(&reversed, interaction.context.wo, &mut share);
            return;
        };
        if !is_polarized {
            return self.depolarize(before, change.x);
        }
        self.transform(before, mueller, change);
        if let Some(flat) = fold_plane {
            self.fold(*flat);
        }
        if let Some(folded_light) = folded_light {
            self.merge_folded(before, folded_light, -branch.wi, interaction.flat);
        }
    }

    fn toward_light(&self, interaction: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self {
        let value = if interaction.is_smoothed() { None } else { Some(*bsdf_cos) };
        self.after_surface(interaction, wi, value, bsdf_cos)
    }

    fn change_along(&self, _: &Interaction<N>, _: DVec3, on_its_way: &Self, light: &FoundLight<N, Self>) -> f64 {
        on_its_way.measured_change(light)
    }

    fn change_of_hit(&self, light: &FoundLight<N, Self>) -> f64 {
        self.measured_change(light)
    }

    fn for_excitation(&self) -> Self {
        Self::initial(self.x, self.compares)
    }

    fn at_polarized_light(&self, light: &Light<Table>, wi: DVec3, emission: &mut Lanes<N>) -> Option<Self> {
        let (axis, degree) = light.polarization().and_then(|sky| sky.toward(wi))?;
        let (mut lit, stokes) = (*self, [1.0, degree as f32, 0.0, 0.0].map(|part| Lanes([part; N])));
        *emission = *emission * lit.receive(-wi, &Column { x: axis, stokes });
        Some(lit)
    }

    fn after_forward_scattering(&self, viewed: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self {
        let z = -viewed.context.wo;
        if let Material::Diffuse(_) = viewed.material {
            let mut after = *self;
            after.depolarize(self, perpendicular(z, self.x));
            return after;
        }
        let lanes = viewed.context.present.nonzero();
        let incoming = Incoming { wi, crosses: wi.dot(viewed.flat) < 0.0, single: false, lanes };
        let drawn = viewed.unfolded(incoming);
        let query = drawn.unwrap_or(incoming);
        let value = viewed.bsdf_value(query.wi);
        let (mut left, mut others) = (value, [Lanes::ZERO; 2]);
        let mut after = self.sent_forward(viewed, query, drawn.is_some(), &mut left);
        if let Some(folded) = viewed.folded_to(incoming) {
            others = [viewed.bsdf_value(folded.wi); 2];
            let other = self.sent_forward(viewed, folded, true, &mut others[1]);
            after.merge(&other, z, &[left, others[1]]);
        }
        if !self.compares {
            *bsdf_cos = Lanes::from_fn(|i| bsdf_cos[i] * (left[i] + others[1][i]) * inverse(value[i] + others[0][i]));
        }
        after
    }

    fn see(&self, _: &Interaction<N>, _: &ScatterContext<N>, light: &Self, world: &World, ray: &Ray) -> SeenPhoton<N> {
        let mut after = Self::at_camera(world, ray);
        let factor = after.receive(-ray.direction, &light.column());
        let change = if self.compares { after.first_weights() + Lanes([-1.0; N]) } else { Lanes::ZERO };
        SeenPhoton { change, factor: Some(factor), stokes: after.stokes() }
    }

    fn to_stored(&self, interaction: &Interaction<N>) -> Self::Stored {
        let is_unneeded = matches!(interaction.material, Material::Diffuse(_)) && !self.compares;
        (!is_unneeded).then(|| Box::new(self.column()))
    }

    fn join(&self, interaction: &Interaction<N>, wi: DVec3, photon: &Self::Stored, bsdf_cos: &mut Lanes<N>) -> Self {
        let mut after = self.toward_light(interaction, wi, bsdf_cos);
        if let Some(light) = photon {
            *bsdf_cos = *bsdf_cos * after.receive(-wi, light);
        }
        after
    }

    fn change_of_joined(&self, _: &Interaction<N>, _: DVec3, _: &Self::Stored, joined: &Self, lanes: Lanes<N>) -> f64 {
        let all = f64::from(lanes.sum());
        if self.compares && all > 0.0 { f64::from((lanes * joined.first_weights()).sum()) / all - 1.0 } else { 0.0 }
    }

    fn convert_stored(photon: &Self::Stored, read: impl Fn(Lanes<N>) -> Lanes<N>) -> Self::Stored {
        photon.as_ref().map(|column| Box::new(Column { x: column.x, stokes: column.stokes.map(read) }))
    }

    fn stokes(&self) -> Option<[Lanes<N>; 3]> {
        (K == 4).then(|| [1, 2, 3].map(|row| Lanes::from_fn(|i| self.weights[i][0][row])))
    }
}
