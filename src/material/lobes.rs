//! How light leaves a material: the kinds of its lobes.

/// The lobes of a material's BSDF: a set of kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// No light leaves.
    pub const NONE: Self = Self(0);
    /// Light is reflected in every direction, independently of where it came from.
    pub const DIFFUSE_REFLECTION: Self = Self(1);
    /// Light is reflected in every direction, mostly near the mirror image.
    pub const GLOSSY_REFLECTION: Self = Self(2);
    /// Light is reflected in one direction.
    pub const DELTA_REFLECTION: Self = Self(4);
    /// Light crosses the surface in every direction, mostly near the refracted one.
    pub const GLOSSY_TRANSMISSION: Self = Self(8);
    /// Light crosses the surface in one direction.
    pub const DELTA_TRANSMISSION: Self = Self(16);
    /// Light is reflected in every direction, but hardly farther than a few degrees from the mirror image.
    pub const NARROW_REFLECTION: Self = Self(32);
    /// Light crosses the surface in every direction, but hardly farther than a few degrees from the refracted one.
    pub const NARROW_TRANSMISSION: Self = Self(64);
    /// All kinds.
    pub const ALL: Self = Self(127);

    /// All lobes of single directions.
    pub const DELTA: Self = Self::DELTA_REFLECTION.union(Self::DELTA_TRANSMISSION);
    /// All lobes that send light in every direction.
    pub const NON_DELTA: Self = Self::BROAD.union(Self::NARROW);
    /// All narrow lobes.
    pub const NARROW: Self = Self::NARROW_REFLECTION.union(Self::NARROW_TRANSMISSION);
    /// All lobes that send light in every direction, except the narrow ones.
    pub const BROAD: Self = Self::DIFFUSE_REFLECTION.union(Self::GLOSSY_REFLECTION).union(Self::GLOSSY_TRANSMISSION);
    /// All lobes that cross the surface.
    pub const TRANSMISSION: Self = Self::NON_DELTA_TRANSMISSION.union(Self::DELTA_TRANSMISSION);
    /// All lobes that cross the surface and send light in every direction.
    pub const NON_DELTA_TRANSMISSION: Self = Self::GLOSSY_TRANSMISSION.union(Self::NARROW_TRANSMISSION);

    /// Returns the kinds that are in either set.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns the kinds that are in both sets.
    #[must_use]
    pub const fn intersection(self, kinds: Self) -> Self {
        Self(self.0 & kinds.0)
    }

    /// Returns the kinds that are not in the other set.
    #[must_use]
    pub const fn without(self, kinds: Self) -> Self {
        Self(self.0 & !kinds.0)
    }

    /// Returns whether the sets share a kind.
    pub const fn intersects(self, kinds: Self) -> bool {
        self.intersection(kinds).0 != 0
    }

    /// Returns whether light leaves in every direction, so that lights can be sampled.
    pub const fn is_wide(self) -> bool {
        self.intersects(Self::NON_DELTA)
    }

    /// Returns whether all non-delta lobes are diffuse, so that `diffuse_bounces` counts the bounce.
    pub const fn is_diffuse(self) -> bool {
        self.intersection(Self::NON_DELTA).0 == Self::DIFFUSE_REFLECTION.0
    }

    /// Returns whether narrow lobes are treated apart from all others that send light in every direction: if there are
    /// no others, or if narrow reflection stands beside diffuse reflection alone.
    pub const fn has_narrow_apart(self) -> bool {
        let others = self.intersection(Self::NON_DELTA).without(Self::NARROW_REFLECTION).0;
        self.is_narrow() || (self.intersects(Self::NARROW_REFLECTION) && others == Self::DIFFUSE_REFLECTION.0)
    }

    /// Returns whether only narrow lobes send light in every direction.
    pub const fn is_narrow(self) -> bool {
        self.intersects(Self::NARROW) && !self.intersects(Self::BROAD)
    }

    /// Returns whether any lobe crosses the surface.
    pub const fn is_transmissive(self) -> bool {
        self.intersects(Self::TRANSMISSION)
    }

    /// Returns whether any light leaves in single directions: the mirror images and refractions of smooth surfaces.
    pub const fn has_delta(self) -> bool {
        self.intersects(Self::DELTA)
    }
}
