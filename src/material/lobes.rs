//! In which ways light leaves a material.

/// The lobes of a material's BSDF: a set of kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// Nothing leaves.
    pub const NONE: Self = Self(0);
    /// Light is reflected in every direction, without memory of where it came from.
    pub const DIFFUSE_REFLECTION: Self = Self(1);
    /// Light is reflected in every direction, mostly near the mirror image.
    pub const GLOSSY_REFLECTION: Self = Self(2);
    /// Light is reflected in one direction.
    pub const DELTA_REFLECTION: Self = Self(4);
    /// Light crosses the surface in every direction, mostly near the refracted one.
    pub const GLOSSY_TRANSMISSION: Self = Self(8);
    /// Light crosses the surface in one direction.
    pub const DELTA_TRANSMISSION: Self = Self(16);
    /// Light is reflected in every direction, but hardly beyond some degrees from the mirror image.
    pub const NARROW_REFLECTION: Self = Self(32);
    /// Light crosses the surface in every direction, but hardly beyond some degrees from the refracted one.
    pub const NARROW_TRANSMISSION: Self = Self(64);
    /// All kinds.
    pub const ALL: Self = Self(127);

    /// All that leaves in single directions.
    pub const DELTA: Self = Self::DELTA_REFLECTION.union(Self::DELTA_TRANSMISSION);
    /// All that leaves in every direction.
    pub const NON_DELTA: Self = Self::BROAD.union(Self::NARROW);
    /// All narrow ones.
    pub const NARROW: Self = Self::NARROW_REFLECTION.union(Self::NARROW_TRANSMISSION);
    /// All that leaves in every direction but by a narrow lobe.
    pub const BROAD: Self = Self::DIFFUSE_REFLECTION.union(Self::GLOSSY_REFLECTION).union(Self::GLOSSY_TRANSMISSION);
    /// All that crosses the surface.
    pub const TRANSMISSION: Self = Self::NON_DELTA_TRANSMISSION.union(Self::DELTA_TRANSMISSION);
    /// All that crosses it in every direction.
    pub const NON_DELTA_TRANSMISSION: Self = Self::GLOSSY_TRANSMISSION.union(Self::NARROW_TRANSMISSION);

    /// The kinds of both.
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The kinds that are in both.
    pub const fn intersection(self, kinds: Self) -> Self {
        Self(self.0 & kinds.0)
    }

    /// Those that are not among these.
    pub const fn without(self, kinds: Self) -> Self {
        Self(self.0 & !kinds.0)
    }

    /// Whether any of these kinds is among them.
    pub const fn intersects(self, kinds: Self) -> bool {
        self.intersection(kinds).0 != 0
    }

    /// Whether light leaves in every direction, so that lights can be sampled.
    pub const fn is_wide(self) -> bool {
        self.intersects(Self::NON_DELTA)
    }

    /// Whether what leaves in every direction has no memory of where it came from: `diffuse_bounces` counts it.
    pub const fn is_diffuse(self) -> bool {
        self.intersection(Self::NON_DELTA).0 == Self::DIFFUSE_REFLECTION.0
    }

    /// Whether narrow lobes are told apart from what else leaves in every direction: where that is diffuse, if there is
    /// anything, and nothing crosses.
    pub const fn has_narrow_apart(self) -> bool {
        let beside = self.intersection(Self::NON_DELTA).without(Self::NARROW_REFLECTION).0;
        self.is_narrow() || (self.intersects(Self::NARROW_REFLECTION) && beside == Self::DIFFUSE_REFLECTION.0)
    }

    /// Whether nothing leaves in every direction but by narrow lobes.
    pub const fn is_narrow(self) -> bool {
        self.intersects(Self::NARROW) && !self.intersects(Self::BROAD)
    }

    /// Whether light crosses the surface in some way.
    pub const fn is_transmissive(self) -> bool {
        self.intersects(Self::TRANSMISSION)
    }

    /// Whether light leaves in single directions, all of it or some: the mirror images and refractions of smooth
    /// surfaces.
    pub const fn has_delta(self) -> bool {
        self.intersects(Self::DELTA)
    }
}
