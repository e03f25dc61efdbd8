/// What a curve describes, which decides how it is read onto the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Share of light that leaves a surface again, 0 to 1.
    Reflectance,
    /// Share of light that crosses a surface, 0 to 1.
    Transmittance,
    /// How much of a whole is one of its parts, 0 to 1: an opacity, an amount in a mix.
    Share,
    /// Radiance, or for a point light intensity; not negative.
    Emission,
    /// Real refractive index of a dielectric; above 1.
    Index,
    /// Absorption coefficient per scene unit, base e; not negative.
    Absorption,
    /// Real part of a metal's refractive index; above 0.
    MetalIndex,
    /// Extinction coefficient of a metal: imaginary part of its index; not negative.
    MetalExtinction,
    /// Thickness of a layer in which light interferes, in nm.
    Thickness,
    /// Share of light that a dye absorbs and may shine again, 0 to 1.
    Excitation,
    /// Power per nm that a dye shines, on any scale; not negative.
    Fluorescence,
}
