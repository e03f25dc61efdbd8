/// What a curve describes. This decides how it is read onto the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Share of light that a surface reflects, 0 to 1.
    Reflectance,
    /// Share of light that a surface transmits, 0 to 1.
    Transmittance,
    /// Share of one part in a whole, 0 to 1: an opacity, or an amount in a mix.
    Share,
    /// Radiance, or intensity of a point light; not negative.
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
    /// Share of light that a dye absorbs and may emit again, 0 to 1.
    Excitation,
    /// Power per nm that a dye emits, on any scale; not negative.
    Fluorescence,
}
